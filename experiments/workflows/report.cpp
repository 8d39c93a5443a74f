#include "experiments/workflows/report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "experiments/output/atomic_file.hpp"
#include "experiments/output/file_descriptor.hpp"
#include "experiments/report/report.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

namespace fs = std::filesystem;
using lab_data::UserError;

nlohmann::json read_document(const fs::path& file) {
    try {
        return nlohmann::json::parse(read_whole_file(file));
    } catch (const nlohmann::json::exception& error) {
        throw UserError({.file = file.string(),
                         .constraint = fmt::format("is not JSON as a run writes it ({})", error.what()),
                         .remedy = "run the command of the run's config.toml again"});
    }
}

}  // namespace

int run_report(const PlainArguments& arguments) {
    const fs::path file = arguments.path / "report.json";
    if (!fs::is_directory(arguments.path))
        throw UserError({.value = arguments.path.string(),
                         .constraint = "is not a folder",
                         .remedy = "name the folder of a run"});
    if (!fs::exists(file))
        throw UserError({.file = file.string(),
                         .constraint = "is missing: the folder holds no finished run",
                         .remedy = "run or resume it first"});
    const fs::path page = arguments.path / "report.html";
    try {
        write_file_atomically(page, report_html(read_document(file)));
    } catch (const std::invalid_argument& error) {
        throw UserError({.file = file.string(),
                         .constraint = fmt::format("cannot be shown ({})", error.what()),
                         .remedy = "run the command of the run's config.toml again"});
    }
    if (arguments.json)
        fmt::print("{}\n", nlohmann::json{{"report", page.string()}}.dump());
    else
        fmt::print("{}\n", page.string());
    return 0;
}

}  // namespace loam::experiments
