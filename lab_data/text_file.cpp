#include "lab_data/text_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <vector>

#include "lab_data/nearest_name.hpp"
#include "lab_data/shown.hpp"
#include "lab_data/utf8.hpp"

namespace loam::lab_data {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t most_names = 1000;  // of a folder, to compare with

/// Where the first byte is that is no UTF-8, or a control character that text does not contain; npos:
/// nowhere.
std::size_t first_non_text(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = utf8_character_length(text.substr(i));
        const auto byte = static_cast<unsigned char>(text[i]);
        const bool control = (byte < 0x20 && (byte < 0x09 || byte > 0x0d)) || byte == 0x7f;
        if (length == 0 || control) return i;
        i += length;
    }
    return std::string_view::npos;
}

std::string in_hexadecimal(char c) {
    constexpr std::string_view digits = "0123456789abcdef";
    const auto byte = static_cast<unsigned char>(c);
    return {'0', 'x', digits[byte >> 4], digits[byte & 15u]};
}

Fault not_text(const fs::path& path, std::string_view text, std::size_t at) {
    const auto lines_before = std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
    Fault fault{.file = path.string(),
                .line = 1 + static_cast<int>(lines_before),
                .constraint = "is not UTF-8 text (byte " + in_hexadecimal(text[at]) + ")",
                .remedy = "save the file with the encoding UTF-8"};
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
        fault.line = 1;
        fault.constraint = "is UTF-16, not UTF-8 text";
        fault.remedy = "save it again as 'CSV UTF-8' or 'UTF-8'";
    } else if (text.starts_with("PK\x03\x04")) {
        fault.line = 0;
        fault.constraint = "is a workbook or an archive, not text";
        fault.remedy = "export the sheet as CSV";
    } else if (text.substr(0, 4096).find('\0') != std::string_view::npos) {
        fault.constraint = "is binary, not text";
        fault.remedy = "give a text file";
    }
    return fault;
}

/// Whether the name stays inside its folder.
bool is_inside_folder(const std::string& file, const Fault& where, Faults& faults) {
    Fault fault = where;
    fault.value = file;
    const fs::path path(file);
    if (file.empty()) {
        fault.constraint = "is empty";
        fault.remedy = "name a file in the folder";
    } else if (std::ranges::any_of(file, [](char c) { return static_cast<unsigned char>(c) < 0x20; })) {
        fault.constraint = "must not contain control characters";
        fault.remedy = "rename the file";
    } else if (file.find('\\') != std::string::npos) {
        fault.constraint = "must not contain backslashes";
        fault.remedy = "separate folders with /";
    } else if (path.is_absolute() || std::ranges::find(path, fs::path("..")) != path.end()) {
        fault.constraint = "must lie in the folder of the file that names it";
        fault.remedy = "copy the file there and give its name without leading / or ..";
    } else {
        return true;
    }
    faults.error(fault);
    return false;
}

}  // namespace

std::string missing_file_remedy(const fs::path& path) {
    const fs::path whole = path.filename().empty() ? path.parent_path() : path;  // without a slash at the end
    const fs::path parent = whole.parent_path().empty() ? fs::path(".") : whole.parent_path();
    std::vector<std::string> names;
    std::error_code error;
    for (fs::directory_iterator entry(parent, error), end;
         !error && entry != end && names.size() < most_names; entry.increment(error))
        if (entry->path().filename() != whole.filename())  // a link to nothing is there and is not
            names.push_back(entry->path().filename().string());
    std::ranges::sort(names);
    const std::vector<std::string_view> views(names.begin(), names.end());
    if (const auto nearest = nearest_name(whole.filename().string(), views))
        return "did you mean '" + shown(*nearest) + "'?";
    return "put it into its folder or correct the name";
}

bool is_in_folder(const fs::path& folder, const std::string& file, const Fault& where, Faults& faults) {
    if (!is_inside_folder(file, where, faults)) return false;
    std::error_code error;
    const fs::file_type type = fs::status(folder / file, error).type();
    const bool is_folder = type == fs::file_type::directory;
    if (!is_folder && type != fs::file_type::not_found) return true;
    Fault fault = where;
    fault.value = file;
    fault.constraint = is_folder ? "is a folder" : "does not exist";
    fault.remedy = is_folder ? "name a file in it" : missing_file_remedy(folder / file);
    faults.error(fault);
    return false;
}

std::optional<std::string> read_text(const fs::path& path, std::size_t largest, Faults& faults) {
    Fault fault{.file = path.string()};
    const auto refuse = [&](std::string constraint, std::string remedy) {
        fault.constraint = std::move(constraint);
        fault.remedy = std::move(remedy);
        faults.error(fault);
        return std::nullopt;
    };
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found) return refuse("does not exist", missing_file_remedy(path));
    if (error) return refuse("cannot be read: " + error.message(), "correct its name or its permissions");
    if (status.type() == fs::file_type::directory) return refuse("is a folder", "name a file in it");
    if (status.type() != fs::file_type::regular) return refuse("is not a regular file", "give a text file");
    const auto size = fs::file_size(path, error);
    if (!error && size > largest)
        return refuse("has " + std::to_string(size) + " bytes; the most is " + std::to_string(largest),
                      "thin the readings out or split the file");
    errno = 0;
    std::ifstream stream(path, std::ios::binary);
    // Not more than promised, should the file grow meanwhile.
    std::string text(error ? largest : static_cast<std::size_t>(size), '\0');
    if (stream) stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (!stream.is_open() || stream.bad())
        return refuse("cannot be read: " + std::string(std::strerror(errno)), "correct its permissions");
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
    const std::size_t bad = first_non_text(text);
    if (bad != std::string::npos) {
        faults.error(not_text(path, text, bad));
        return std::nullopt;
    }
    return text;
}

}  // namespace loam::lab_data
