// What a run reads (sample, packing) and where it writes: resolved names, the digest, the run folder.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "experiments/settings/reading.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/settings/writing.hpp"
#include "lab_data/data_set.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

namespace fs = std::filesystem;
using lab_data::UserError;

const fs::path sand = fs::path(LOAM_SOURCE_DIR) / "lab_data/sets/dobrany_sand";

class InFolder : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "loam-settings-XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder = name;
    }
    void TearDown() override { fs::remove_all(folder); }

    Settings settings(std::vector<Override> more = {}) const {
        std::vector<Override> given{{"sample", sand.string()}, {"out", (folder / "run").string()}};
        given.insert(given.end(), more.begin(), more.end());
        return read_settings("calibrate", "", given);
    }

    static std::string complaint_of(const auto& action) {
        try {
            action();
        } catch (const UserError& error) {
            return error.what();
        }
        return "";
    }

    fs::path folder;
};

TEST_F(InFolder, TheRunIsNamedAfterVerbAndSample) {
    const Settings found = read_settings("calibrate", "", {{"sample", sand.string()}});
    EXPECT_EQ(found.out, fs::current_path() / "runs/calibrate-dobrany-sand");
    EXPECT_EQ(found.sample, fs::canonical(sand));
}

TEST_F(InFolder, AMissingSampleIsTheUsersFault) {
    EXPECT_NE(complaint_of([] { read_settings("calibrate", "", {}); }).find("'sample' is missing"),
              std::string::npos);
    EXPECT_THROW(read_settings("calibrate", "", {{"sample", (folder / "nothing").string()}}), UserError);
}

TEST_F(InFolder, HeldOutTestsAreNamedByFileOrPath) {
    const std::string file = "triaxial_drained_200kPa.csv";
    EXPECT_EQ(settings({{"hold_out", file}}).hold_out, std::vector{file});
    EXPECT_EQ(settings({{"hold_out", (sand / file).string()}}).hold_out, std::vector{file});
    const std::string said = complaint_of([&] { settings({{"hold_out", "triaxial_drained_20kPa.csv"}}); });
    EXPECT_NE(said.find("is not a test of the sample dobrany-sand; did you mean"), std::string::npos) << said;
}

TEST_F(InFolder, SomethingMustBeLeftToSimulateAndToFit) {
    const auto said = [&](std::vector<Override> given) { return complaint_of([&] { settings(given); }); };
    const std::string other = (sand.parent_path() / "toyoura_sand").string();
    EXPECT_NE(said({{"tests", "direct_shear"}}).find("'direct_shear' is not among the tests of the sample"),
              std::string::npos);
    EXPECT_NE(said({{"tests", "oedometer"}, {"sample", other}})
                  .find("'oedometer' is not among the tests of the sample toyoura-sand"),
              std::string::npos);
    EXPECT_NE(said({{"tests", "oedometer"}, {"hold_out", "oedometer_1.csv"}}).find("leaves no test to fit"),
              std::string::npos);
    EXPECT_EQ(said({{"tests", "oedometer"}}), "");
}

TEST_F(InFolder, TheDigestFollowsTheData) {
    const fs::path copy = folder / "copy";
    fs::copy(sand, copy);
    const auto digest = [&](const fs::path& sample) {
        return settings({{"sample", sample.string()}}).inputs_digest;
    };
    EXPECT_EQ(digest(copy), digest(sand));  // wherever it lies
    std::ofstream(copy / "oedometer_1.csv", std::ios::app) << "\n";
    EXPECT_NE(digest(copy), digest(sand));
}

TEST_F(InFolder, ThePackingIsPartOfTheDigest) {
    std::ofstream(folder / "packing.csv") << "# periodic cell x,y,z in m: 1,1,1\n";
    EXPECT_NE(settings({{"packing", (folder / "packing.csv").string()}}).inputs_digest,
              settings().inputs_digest);
    EXPECT_THROW(settings({{"packing", (folder / "absent.csv").string()}}), UserError);
}

TEST_F(InFolder, AConfigurationCanStandForTheCommandLine) {
    const Settings first = settings({{"particles", "321"}});
    { const RunFolder run(first); }
    EXPECT_EQ(read_settings("calibrate", folder / "run/config.toml", {}), first);
}

TEST_F(InFolder, TheSameSettingsContinueARun) {
    const Settings given = settings();
    {
        const RunFolder run(given);
        EXPECT_FALSE(run.resumed());
        EXPECT_EQ(read_configuration(run.file("config.toml")), given);
    }
    Settings again = given;
    again.jobs = 1;
    EXPECT_TRUE(RunFolder(again).resumed());
}

TEST_F(InFolder, OtherSettingsDoNot) {
    { const RunFolder run(settings()); }
    std::ofstream(folder / "run/ensemble.h5") << "simulations";
    const std::string said = complaint_of([&] { RunFolder{settings({{"seed", "2"}})}; });
    EXPECT_NE(said.find("key 'seed' is 1 in the run stored there and 2 now"), std::string::npos) << said;
    EXPECT_NE(said.find("give another --out"), std::string::npos) << said;
    Settings other_data = settings();
    other_data.inputs_digest = "0";
    EXPECT_NE(complaint_of([&] { RunFolder{other_data}; }).find("other data"), std::string::npos);
}

TEST_F(InFolder, ARunThatCameToNothingLeavesItsPlace) {
    { const RunFolder run(settings()); }
    const Settings other = settings({{"seed", "2"}});
    const RunFolder run(other);
    EXPECT_EQ(read_configuration(run.file("config.toml")), other);
}

/// The whole file.
std::string text_of(const fs::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST_F(InFolder, AConfigurationOfTheUsersOwnIsLeftAlone) {
    const std::string own = "# my settings\nverb = \"calibrate\"\nparticles = 300\n";
    const fs::path file = folder / "run/config.toml";
    fs::create_directory(folder / "run");
    std::ofstream(file) << own;
    const auto refused = [&](const auto& action) {
        const std::string said = complaint_of(action);
        EXPECT_NE(said.find("holds a config.toml that is not of a run"), std::string::npos) << said;
        EXPECT_EQ(text_of(file), own);
    };
    refused([&] { RunFolder{settings()}; });
    refused([&] { RunFolder{settings({{"particles", "300"}})}; });
    const std::vector<Override> given{{"sample", sand.string()}, {"out", (folder / "run").string()}};
    refused([&] { read_settings("calibrate", file, given); });
    fs::create_directory_symlink(folder / "run", folder / "link");
    refused([&] { read_settings("calibrate", folder / "link/config.toml", given); });
    std::ofstream(folder / "run/notes.txt") << "x";
    refused([&] { RunFolder{settings()}; });
    fs::create_directory(folder / "run/.git");
    refused([&] { RunFolder{settings()}; });
    // Read from there, it may serve a run elsewhere.
    EXPECT_EQ(read_settings("calibrate", file, {given[0], {"out", (folder / "new").string()}}).particles,
              300);
}

TEST_F(InFolder, ARunsConfigurationThatIsReadIsNotReplaced) {
    { const RunFolder run(settings()); }
    const fs::path file = folder / "run/config.toml";
    std::ofstream(file, std::ios::app) << "# a note\n";
    const std::string before = text_of(file);
    const std::string said = complaint_of([&] { read_settings("calibrate", file, {{"seed", "2"}}); });
    EXPECT_NE(said.find("key 'seed' is 1 in the run stored there and 2 now"), std::string::npos) << said;
    EXPECT_TRUE(RunFolder(read_settings("calibrate", file, {})).resumed());
    EXPECT_EQ(text_of(file), before);
    std::ofstream(folder / "run/ensemble.h5") << "simulations";
    EXPECT_TRUE(RunFolder(read_settings("calibrate", file, {})).resumed());
    EXPECT_EQ(text_of(file), before);
}

TEST_F(InFolder, APathThatIsNotUtf8IsRefusedBeforeAnyRun) {
    const auto refused = [&](const char* name, const auto& action) {
        const std::string said = complaint_of(action);
        EXPECT_NE(said.find(name), std::string::npos) << said;
        EXPECT_NE(said.find("caf\\xe9' is not UTF-8"), std::string::npos) << said;
    };
    const fs::path bad = folder / "caf\xe9";
    refused("'--out': ", [&] { settings({{"out", bad.string()}}); });
    refused("'--packing': ", [&] { settings({{"packing", bad.string()}}); });
    refused("'sample': ", [&] { settings({{"sample", bad.string()}}); });
    fs::copy(sand, bad);
    refused("'sample': ", [&] { settings({{"sample", bad.string()}}); });
    refused("'--config': ", [&] { read_settings("calibrate", bad, {}); });
    // What a link or the working directory makes of it counts too.
    fs::create_directory_symlink(bad, folder / "link");
    refused("'sample': ", [&] { settings({{"sample", (folder / "link").string()}}); });
    const fs::path before = fs::current_path();
    fs::current_path(bad);
    EXPECT_NE(complaint_of([] {
                  read_settings("calibrate", "", {{"sample", sand.string()}});
              }).find("UTF-8"),
              std::string::npos);
    fs::current_path(before);
    EXPECT_EQ(complaint_of([&] { settings({{"out", (folder / "caf\xc3\xa9").string()}}); }), "");
}

TEST_F(InFolder, SamplesArePairedByACovariateThatIsThere) {
    const fs::path set = fs::path(LOAM_SOURCE_DIR) / "lab_data/sets/flanders_twin_125";
    const auto said = [&](const std::string& name) {
        std::ofstream(folder / "bulk.toml") << "[bulk]\npaired_by = \"" << name << "\"\n";
        return complaint_of([&] { read_settings("bulk", folder / "bulk.toml", {{"sample", set.string()}}); });
    };
    const std::string covariate = lab_data::read_data_set(set).covariates.at(0);
    EXPECT_EQ(said(covariate), "");
    EXPECT_EQ(said(""), "");
    const std::string wrong = said(covariate + "s");
    EXPECT_NE(wrong.find("bulk.toml:2:1: key 'bulk.paired_by'"), std::string::npos) << wrong;
    EXPECT_NE(wrong.find("is not a covariate of the data set"), std::string::npos) << wrong;
    EXPECT_NE(wrong.find("did you mean '" + covariate + "'?"), std::string::npos) << wrong;
}

TEST_F(InFolder, OneProcessAtATime) {
    const RunFolder run(settings());
    EXPECT_NE(complaint_of([&] { RunFolder{settings()}; }).find("in use by another loam"), std::string::npos);
}

TEST_F(InFolder, AFolderOfSomethingElseIsLeftAlone) {
    fs::create_directory(folder / "run");
    std::ofstream(folder / "run/thesis.tex") << "x";
    EXPECT_NE(complaint_of([&] { RunFolder{settings()}; }).find("not the folder of a run"),
              std::string::npos);
    EXPECT_FALSE(fs::exists(folder / "run/config.toml"));
}

TEST_F(InFolder, AFileInTheWayIsTheUsersFault) {
    std::ofstream(folder / "run") << "x";
    EXPECT_THROW(RunFolder{settings()}, UserError);
}

}  // namespace
}  // namespace loam::experiments
