#include "lab_data/user_error.hpp"

#include <cstdio>
#include <string_view>

namespace loam::lab_data {
namespace {

/// The value as it can be shown on a terminal: cut to 60 bytes, control bytes escaped.
std::string shown(std::string_view value) {
    constexpr std::size_t longest = 60;
    std::string text;
    for (const char c : value.substr(0, longest)) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 0x20 && byte != 0x7f) {
            text += c;
            continue;
        }
        char escaped[8];
        std::snprintf(escaped, sizeof escaped, "\\x%02x", static_cast<unsigned>(byte));
        text += escaped;
    }
    if (value.size() > longest) text += "...";
    return text;
}

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
        text += shown(fault.file);
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

UserError::UserError(Fault fault) : std::runtime_error(message(fault)), fault_(std::move(fault)) {}

}  // namespace loam::lab_data
