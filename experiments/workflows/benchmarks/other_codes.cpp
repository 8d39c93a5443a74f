#include "experiments/workflows/benchmarks/other_codes.hpp"

#include <fmt/format.h>
#include <stdlib.h>

#include <array>
#include <stdexcept>

#include "experiments/workflows/benchmarks/child_process.hpp"
#include "lab_data/number.hpp"

namespace loam::experiments {
namespace {

namespace fs = std::filesystem;

constexpr std::array yade_laws{
    LawName{SharedLaw::linear, "Law2_ScGeom_FrictPhys_CundallStrack"},
    LawName{SharedLaw::cohesive, "Law2_ScGeom6D_CohFrictPhys_CohesionMoment"},
    LawName{SharedLaw::hertz, "Law2_ScGeom_MindlinPhys_Mindlin"},
};
constexpr std::array lammps_laws{
    LawName{SharedLaw::linear, "gran/hooke/history"},
    LawName{SharedLaw::hertz, "gran/hertz/history"},
};

constexpr std::array known_codes{
    OtherCode{"yade", "yade", "yade", yade_laws, write_yade_input, read_yade_output},
    OtherCode{"lammps", "lmp", "lammps", lammps_laws, write_lammps_input, read_lammps_output},
};

/// A folder of its own under the system's temporary one, removed with all in it.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string pattern = (fs::temp_directory_path() / "loam-bench-XXXXXX").string();
        if (mkdtemp(pattern.data()) == nullptr)
            throw std::runtime_error("no temporary folder can be made in " +
                                     fs::temp_directory_path().string());
        path_ = pattern;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

/// One thread, nothing left in the user's folders, and no daemon beside a lone MPI process.
std::vector<std::pair<std::string, std::string>> environment_in(const fs::path& folder) {
    return {{"OMP_NUM_THREADS", "1"},
            {"OMPI_MCA_ess_singleton_isolated", "1"},
            {"HOME", folder.string()},
            {"TMPDIR", folder.string()},
            {"LC_ALL", "C.UTF-8"}};
}

std::string last_lines(const std::string& output) {
    constexpr std::size_t shown = 600;
    return output.size() <= shown ? output : "…" + output.substr(output.size() - shown);
}

}  // namespace

std::span<const OtherCode> other_codes() {
    return known_codes;
}

const OtherCode* find_code(std::string_view name) {
    for (const OtherCode& code : known_codes)
        if (code.name == name) return &code;
    return nullptr;
}

std::string_view name_of_law(const OtherCode& code, SharedLaw law) {
    for (const LawName& entry : code.laws)
        if (entry.law == law) return entry.name;
    return {};
}

Timing run_other_code(const OtherCode& code, const fs::path& program, const SharedWork& work,
                      const StopToken& stop) {
    const TemporaryFolder folder;
    const ChildResult result = run_child({.program = program,
                                          .arguments = code.write_input(work, folder.path()),
                                          .folder = folder.path(),
                                          .environment = environment_in(folder.path())},
                                         stop);
    const std::optional<Timing> timing = code.read_output(result.output, work);
    if (result.status != 0 || !timing || !(timing->seconds > 0))
        throw std::runtime_error(
            fmt::format("{} ended with status {} and without a time; its last words:\n{}", program.string(),
                        result.status, last_lines(result.output)));
    return *timing;
}

std::optional<double> said_number(std::string_view output, std::string_view name) {
    const std::string key = fmt::format("loam-bench {} ", name);
    const std::size_t start = output.rfind(key);
    if (start == std::string_view::npos) return std::nullopt;
    const std::string_view rest = output.substr(start + key.size());
    return lab_data::parse_number(rest.substr(0, rest.find_first_of(" \r\n")));
}

}  // namespace loam::experiments
