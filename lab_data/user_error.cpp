#include "lab_data/user_error.hpp"

#include <cstdio>
#include <string_view>

#include "lab_data/shown.hpp"
#include "lab_data/utf8.hpp"

namespace loam::lab_data {
namespace {

constexpr std::size_t longest_path = 4096;

/// What the name stands for follows from where it was written.
std::string_view kind_of_name(const Fault& fault) {
    if (fault.file.ends_with(".csv")) return "column ";
    if (fault.file.ends_with(".toml")) return "key ";
    if (fault.column.starts_with("--")) return "option ";
    return "";
}

std::string message(const Fault& fault) {
    std::string text;
    if (!fault.file.empty()) {
        text += shown(fault.file, longest_path);
        if (fault.line > 0) text.append(":").append(std::to_string(fault.line));
        if (fault.line > 0 && fault.position > 0) text.append(":").append(std::to_string(fault.position));
        text += ": ";
    }
    if (!fault.column.empty()) {
        text.append(kind_of_name(fault)).append("'").append(shown(fault.column)).append("'");
        text += fault.value.empty() ? " " : ": ";
    }
    if (!fault.value.empty()) text.append("value '").append(shown(fault.value)).append("' ");
    text += fault.constraint;
    if (!fault.remedy.empty()) text.append("; ").append(fault.remedy);
    return text;
}

}  // namespace

std::string shown(std::string_view value, std::size_t longest) {
    std::string text;
    std::size_t i = 0;
    while (i < value.size() && i < longest) {
        const auto byte = static_cast<unsigned char>(value[i]);
        const std::size_t length = utf8_character_length(value.substr(i));
        if (length > 0 && byte >= 0x20 && byte != 0x7f) {
            text += value.substr(i, length);
            i += length;
            continue;
        }
        char escaped[8];
        std::snprintf(escaped, sizeof escaped, "\\x%02x", static_cast<unsigned>(byte));
        text += escaped;
        ++i;
    }
    if (i < value.size()) text += "...";
    return text;
}

UserError::UserError(Fault fault) : std::runtime_error(message(fault)), fault_(std::move(fault)) {}

}  // namespace loam::lab_data
