// Other codes of the engine's benchmark: their input, their output as they write it, the rows of a
// comparison.
#include <fstream>

#include "experiments/workflows/benchmarks/against.hpp"
#include "experiments/workflows/benchmarks/child_process.hpp"
#include "experiments/workflows/benchmarks/engine_work.hpp"
#include "store_helpers.hpp"

namespace loam::experiments {
namespace {

using testing::TemporaryFolder;

// The end of what LAMMPS 2022-01-06 wrote for 10,000 steps of 700 particles on a busy machine, after a
// warm-up.
constexpr std::string_view lammps_output = R"(Loop time of 0.221445 on 1 procs for 1000 steps with 700 atoms

45.5% CPU use with 1 MPI tasks x 1 OpenMP threads

Total # of neighbors = 2199
Ave neighs/atom = 3.1414286
Neighbor list builds = 6
Dangerous builds = 0
Setting up Verlet run ...
  Unit style    : si
  Current step  : 1000
  Time step     : 7.730217954165208e-05
Per MPI rank memory allocation (min/avg/max) = 7.520 | 7.520 | 7.520 Mbytes
Step Temp E_pair E_mol TotEng Press Volume 
    1000 3.5441467e+18            0            0  0.051305491    366575.97   0.88875263 
    6714 1.2591716e+18            0            0  0.018227919    484907.36   0.88570563 
Loop time of 1.23633 on 1 procs for 5714 steps with 700 atoms

48.0% CPU use with 1 MPI tasks x 1 OpenMP threads

Total # of neighbors = 2211
Ave neighs/atom = 3.1585714
Neighbor list builds = 17
Dangerous builds = 0
Setting up Verlet run ...
  Unit style    : si
  Current step  : 6714
  Time step     : 7.730217954165208e-05
Per MPI rank memory allocation (min/avg/max) = 7.520 | 7.520 | 7.520 Mbytes
Step c_contacts 
    6714         3440 
Loop time of 5.28e-07 on 1 procs for 0 steps with 700 atoms

189.4% CPU use with 1 MPI tasks x 1 OpenMP threads

Total # of neighbors = 2210
Ave neighs/atom = 3.1571429
Neighbor list builds = 0
Dangerous builds = 0
loam-bench contacts 1720
Total wall time: 0:00:01
)";

// The same of YADE 2023.02a.
constexpr std::string_view yade_output = R"(Welcome to Yade 2023.02a 
Using python version: 3.11.2 (main, Apr 28 2025, 14:11:48) [GCC 12.2.0]
XMLRPC info provider on http://localhost:21001
Running script work.py
loam-bench seconds 2.00596846
loam-bench contacts 1713
)";

SharedWork small_work(SharedLaw law) {
    SharedWork work;
    work.law = law;
    work.packing.cell = Eigen::Vector3d(1, 2, 3).asDiagonal();
    work.packing.centres = Eigen::Matrix3Xd::Constant(3, 2, 0.25);
    work.packing.radii = Eigen::Vector2d(0.05, 0.06);
    work.time_step = 1e-5;
    work.strain_rate = 0.5;
    work.warm_up = 100;
    work.steps = 5714;
    return work;
}

TEST(OtherCodes, TimeAndContactsOfLammpsAreThoseOfTheTimedRun) {
    const auto timing = read_lammps_output(lammps_output, small_work(SharedLaw::linear));
    ASSERT_TRUE(timing);
    EXPECT_DOUBLE_EQ(timing->seconds,
                     1.23633 * 48.0 / 100);  // of the processor: not all of the loop's time was its own
    EXPECT_DOUBLE_EQ(timing->contacts, 1720);
}

TEST(OtherCodes, TimeAndContactsOfYade) {
    const auto timing = read_yade_output(yade_output, small_work(SharedLaw::cohesive));
    ASSERT_TRUE(timing);
    EXPECT_DOUBLE_EQ(timing->seconds, 2.00596846);
    EXPECT_DOUBLE_EQ(timing->contacts, 1713);
}

TEST(OtherCodes, OutputCutShortIsNoTime) {
    SharedWork other = small_work(SharedLaw::linear);
    other.steps = 5000;
    EXPECT_FALSE(read_lammps_output(lammps_output, other));  // the time of another run
    EXPECT_FALSE(read_lammps_output(lammps_output.substr(0, lammps_output.find("CPU use")),
                                    small_work(SharedLaw::linear)));
    EXPECT_FALSE(read_lammps_output(lammps_output.substr(0, lammps_output.find("loam-bench")),
                                    small_work(SharedLaw::linear)));
    EXPECT_FALSE(read_yade_output(yade_output.substr(0, yade_output.find("loam-bench contacts")),
                                  small_work(SharedLaw::linear)));
    EXPECT_FALSE(read_lammps_output("", other));
    EXPECT_FALSE(read_yade_output("", other));
}

TEST(OtherCodes, InputNamesTheLawAndHoldsThePacking) {
    for (const OtherCode& code : other_codes())
        for (const LawName& entry : code.laws) {
            const TemporaryFolder folder;
            const SharedWork work = small_work(entry.law);
            const std::string input = code.write_input(work, folder.path()).back();
            const std::string text = read_whole_file(folder.path() / input);
            EXPECT_NE(text.find(entry.name), std::string::npos) << text;
            EXPECT_NE(text.find("5714"), std::string::npos) << text;
            std::string packing;
            for (const std::string& file : testing::files_in(folder.path()))
                if (file != input) packing = read_whole_file(folder.path() / file);
            EXPECT_NE(packing.find("0.25 0.25 0.25"), std::string::npos) << packing;
        }
}

TEST(OtherCodes, ANumberThatAScriptSays) {
    EXPECT_EQ(said_number("a\nloam-bench seconds 1.5\nloam-bench seconds 2.5\n", "seconds"), 2.5);
    EXPECT_FALSE(said_number("loam-bench seconds nan\n", "seconds"));
    EXPECT_FALSE(said_number("loam-bench seconds 1\n", "contacts"));
}

// Programs of ours in the place of YADE.
std::filesystem::path write_script(const TemporaryFolder& folder, const std::string& name,
                                   const std::string& text) {
    const auto path = folder.path() / name;
    std::ofstream(path) << "#!/bin/sh\n" << text;
    std::filesystem::permissions(path, std::filesystem::perms(0755));
    return path;
}

const AgainstOptions brief{.particles = {150}, .repeats = 3, .warm_up = 10, .work = 0, .fewest_steps = 50};

TEST(Against, RowsAreMediansWithTheRatioOfThisEngine) {
    const TemporaryFolder folder;
    // 1 s, 2 s and 4 s, in turn.
    const auto program = write_script(
        folder, "steady",
        "cd \"${0%/*}\"; echo x >> runs; echo loam-bench seconds $((1 << ($(grep -c x runs) - 1) "
        "% 3)); echo loam-bench contacts 300\n");
    const InstalledCode code{find_code("yade"), program};
    int runs = 0;
    const AgainstResult result = compare_codes({code}, brief, {}, [&] { ++runs; });
    EXPECT_EQ(result.failures, std::vector<std::string>());
    EXPECT_EQ(static_cast<std::size_t>(runs), other_runs({code}, brief));
    ASSERT_GE(result.rows.size(), 4u);
    const SpeedRow& ours = result.rows[0];
    const SpeedRow& theirs = result.rows[1];
    EXPECT_EQ(ours.code, "loam");
    EXPECT_EQ(ours.ratio, 1);
    EXPECT_EQ(theirs.code, "yade");
    EXPECT_EQ(theirs.law, "linear-cohesive");
    EXPECT_EQ(theirs.rotation, "blocked");
    EXPECT_EQ(theirs.its_law, "Law2_ScGeom6D_CohFrictPhys_CohesionMoment");
    EXPECT_DOUBLE_EQ(theirs.particle_steps_per_s, 150 * 50 / 2.0);
    EXPECT_DOUBLE_EQ(theirs.contact_steps_per_s, 300 * 50 / 2.0);
    EXPECT_GT(theirs.ratio, 1);
    const nlohmann::json json = to_json(theirs);
    for (const char* key : {"code", "law", "rotation", "particles", "threads", "particle_steps_per_s",
                            "contact_steps_per_s", "ratio"})
        EXPECT_TRUE(json.contains(key)) << key;
}

TEST(Against, ACodeThatFailsIsNamedAndLeftOut) {
    const TemporaryFolder folder;
    const auto program = write_script(folder, "failing", "echo no licence today; exit 7\n");
    int runs = 0;
    const AgainstResult result = compare_codes({{find_code("yade"), program}}, brief, {}, [&] { ++runs; });
    EXPECT_EQ(runs, 1);
    ASSERT_EQ(result.failures.size(), 1u);
    EXPECT_NE(result.failures[0].find("status 7"), std::string::npos) << result.failures[0];
    EXPECT_NE(result.failures[0].find("no licence today"), std::string::npos) << result.failures[0];
    for (const SpeedRow& row : result.rows) EXPECT_EQ(row.code, "loam");
}

/// Where the codes are installed: the same packing in the same state has as many contacts in each.
TEST(Against, CodesThatAreInstalledHaveAsManyContacts) {
    std::vector<InstalledCode> codes;
    for (const OtherCode& code : other_codes())
        if (const auto program = find_program(code.program)) codes.push_back({&code, *program});
    if (codes.empty()) GTEST_SKIP() << "neither yade nor lammps is installed";
    const AgainstOptions options{
        .particles = {500}, .repeats = 1, .warm_up = 500, .work = 0, .fewest_steps = 500};
    const AgainstResult result = compare_codes(codes, options, {}, [] {});
    EXPECT_EQ(result.failures, std::vector<std::string>());
    double ours = 0;
    for (const SpeedRow& row : result.rows) {
        const double contacts = row.contact_steps_per_s / row.particle_steps_per_s;
        if (row.code == "loam") ours = contacts;
        EXPECT_GT(contacts, 2) << row.code << " " << row.its_law;
        EXPECT_NEAR(contacts, ours, 0.04 * ours) << row.code << " " << row.its_law;
    }
}

}  // namespace
}  // namespace loam::experiments
