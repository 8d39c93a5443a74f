#include "lab_data/number.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace loam::lab_data {
namespace {

std::string replaced(std::string_view text, std::string_view from, std::string_view to) {
    std::string result(text);
    for (std::size_t at = result.find(from); at != std::string::npos; at = result.find(from, at + to.size()))
        result.replace(at, from.size(), to);
    return result;
}

bool is_missing_mark(std::string_view text) {
    constexpr std::array<std::string_view, 8> marks{"-", "--", "NA", "N/A", "n/a", "na", "NaN", "nan"};
    return text.empty() || std::ranges::find(marks, text) != marks.end();
}

}  // namespace

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view space = " \t\r\n\f\v";
    const std::size_t first = text.find_first_not_of(space);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(space) - first + 1);
}

std::optional<double> parse_number(std::string_view text) {
    text = trimmed(text);
    // from_chars knows no plus sign, and would take "inf" and "nan".
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    const std::size_t first = text.starts_with('-') ? 1 : 0;
    if (text.size() <= first || !(text[first] == '.' || (text[first] >= '0' && text[first] <= '9')))
        return std::nullopt;
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

std::string number_remedy(std::string_view text) {
    text = trimmed(text);
    if (is_missing_mark(text)) return "give the value, or leave the whole row out";
    if (text.size() > 1 && text[0] == '#' && text[1] >= 'A' && text[1] <= 'Z')
        return "the spreadsheet could not compute this cell: correct it there and export again";
    if (text.starts_with('#')) return "write a number, or put the line above the header if it is a comment";
    if (text.size() > 40) return "write a number such as 0.0125";
    const std::string minus_sign =
        replaced(text, "\xe2\x88\x92", "-");  // U+2212, as typesetting programs write it
    if (parse_number(minus_sign)) return "write " + minus_sign + " with a plain hyphen as minus sign";
    const std::string with_point = replaced(text, ",", "."), without = replaced(text, ",", "");
    const bool may_be_thousands = text.size() > 4 && text[text.size() - 4] == ',' && text.front() != '0';
    if (with_point != text && parse_number(with_point) && may_be_thousands)
        return "write " + without + " without separators of thousands, or " + with_point +
               " if the comma is a decimal one";
    if (with_point != text && parse_number(with_point))
        return "write " + with_point + " with a decimal point, and no separators of thousands";
    if (without != text && parse_number(without))
        return "write " + without + " without separators of thousands";
    if (parse_number(replaced(text, " ", ""))) return "write " + replaced(text, " ", "") + " without spaces";
    if (text.ends_with('%') && parse_number(text.substr(0, text.size() - 1)))
        return "leave out the percent sign and end the name with _percent";
    const std::size_t letters = text.find_first_not_of("+-.0123456789 ");
    const bool may_be_unit = letters != std::string_view::npos && letters > 0 &&
                             std::string_view("eExX").find(text[letters]) == std::string_view::npos;
    if (may_be_unit && parse_number(text.substr(0, letters)))
        return "write " + std::string(trimmed(text.substr(0, letters))) + " alone if '" +
               std::string(text.substr(letters)) + "' is a unit, which belongs in the name";
    return "write a number such as 0.0125";
}

}  // namespace loam::lab_data
