#include "lab_data/gather.hpp"

#include <algorithm>

#include "lab_data/text_file.hpp"

namespace loam::lab_data {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t longest_name = 100;

/// Run folders are called after it.
void check_name(const std::string& name, const TomlTable& root, Faults& faults) {
    const auto unfit = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == '/' || c == '\\'; };
    if (name.size() <= longest_name && !name.starts_with('.') && !std::ranges::any_of(name, unfit)) return;
    Fault fault = root.at("name");
    fault.constraint = "must be fit for the name of a folder";
    fault.remedy = "use letters, digits, - and _, at most " + std::to_string(longest_name);
    faults.error(fault);
}

}  // namespace

template <class T>
void read_identity(const TomlTable& root, T& of, Faults& faults) {
    of.name = root.needed_text("name", "name it, such as name = \"my-sand\"");
    check_name(of.name, root, faults);
    of.source = root.needed_text("source", "say where the numbers come from: source = \"...\"");
    of.licence =
        root.needed_text("licence", "say how the data may be used: licence = \"CC0-1.0\" or \"private\"");
    of.description = root.text("description");
    of.notes = root.text("notes");
    of.attribution = root.text("attribution");
    of.measured = root.boolean("measured").value_or(true);
}
template void read_identity<Sample>(const TomlTable&, Sample&, Faults&);
template void read_identity<DataSet>(const TomlTable&, DataSet&, Faults&);

std::optional<fs::path> locate(const fs::path& path, std::string_view name, Faults& faults) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    const bool is_folder = status.type() == fs::file_type::directory;
    const std::string_view other = name == sample_file ? data_set_file : sample_file;
    const bool is_other = is_folder ? !fs::exists(path / name, error) && fs::exists(path / other, error)
                                    : path.filename() == other && fs::exists(path, error);
    if (is_other) {
        const bool is_set = other == data_set_file;
        faults.error({.file = path.string(),
                      .constraint = is_set ? "is a data set, not a sample" : "is a sample, not a data set",
                      .remedy = is_set ? "give it to loam bulk, which fits every sample of a data set"
                                       : "give it to loam calibrate, which fits one sample"});
        return std::nullopt;
    }
    if (is_folder) return path / name;
    if (path.filename() == name) return path;
    const bool missing = status.type() == fs::file_type::not_found;
    faults.error(
        {.file = path.string(),
         .constraint = missing ? "does not exist" : "is not a folder",
         .remedy = missing ? missing_file_remedy(path) : "name the folder that holds " + std::string(name)});
    return std::nullopt;
}

}  // namespace loam::lab_data
