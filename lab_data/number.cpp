#include "lab_data/number.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "lab_data/shown.hpp"

namespace loam::lab_data {
namespace {

std::string replaced(std::string_view text, std::string_view from, std::string_view to) {
    std::string result(text);
    for (std::size_t at = result.find(from); at != std::string::npos; at = result.find(from, at + to.size()))
        result.replace(at, from.size(), to);
    return result;
}

// U+00A0, U+202F, U+2009: a space that breaks no line, a narrow one, a thin one.
constexpr std::array<std::string_view, 4> spaces{" ", "\xc2\xa0", "\xe2\x80\xaf", "\xe2\x80\x89"};
// Between digits: the spaces, as ISO 80000 has it; the apostrophe of Switzerland, straight and curved;
// others.
constexpr std::array<std::string_view, 9> thousands{
    " ", "\xc2\xa0", "\xe2\x80\xaf", "\xe2\x80\x89", "'", "\xe2\x80\x99", "_", ",", "."};

bool is_missing_mark(std::string_view text) {
    constexpr std::array<std::string_view, 8> marks{"-", "--", "NA", "N/A", "n/a", "na", "NaN", "nan"};
    return text.empty() || std::ranges::find(marks, text) != marks.end();
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Without the spaces, also those of other widths, that may stand before a unit.
std::string_view trimmed_at_start(std::string_view text) {
    for (bool found = true; found;) {
        found = false;
        for (const std::string_view space : spaces) {
            if (!text.starts_with(space)) continue;
            text.remove_prefix(space.size());
            found = true;
        }
    }
    return text;
}

/// Where the longest run of digits, signs, points, commas and separators of thousands ends, with its
/// exponent.
std::size_t end_of_number(std::string_view text) {
    std::size_t i = 0, end = 0;
    const auto step = [&]() -> std::size_t {
        if (is_digit(text[i]) || text[i] == '.' || text[i] == ',') return 1;
        if ((text[i] == '+' || text[i] == '-') && i == 0) return 1;
        for (const std::string_view separator : thousands)
            if (text.substr(i).starts_with(separator)) {
                const std::size_t next = i + separator.size();
                return next < text.size() && is_digit(text[next]) ? separator.size() : 0;
            }
        if ((text[i] != 'e' && text[i] != 'E') || i == 0) return 0;
        std::size_t next = i + 1;
        if (next < text.size() && (text[next] == '+' || text[next] == '-')) ++next;
        return next < text.size() && is_digit(text[next]) ? next - i : 0;
    };
    while (i < text.size()) {
        const std::size_t length = step();
        if (length == 0) break;
        i += length;
        end = i;
    }
    return end;
}

/// What follows a number as a unit, rather than as a fraction, a date or an exponent of another program.
bool begins_unit(std::string_view text) {
    if (text.empty()) return false;
    const char c = text.front();
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    const bool begins = letter || c == '%' || static_cast<unsigned char>(c) >= 0x80;
    const bool exponent = letter && std::string_view("eEdDxX").find(c) != std::string_view::npos &&
                          (text.size() < 2 || is_digit(text[1]) || text[1] == '+' || text[1] == '-');
    return begins && !exponent && !(c == 'x' || c == 'X');
}

/// Whether `text` is digits in groups of three between separators, of which the first may be shorter.
bool is_grouped(std::string_view text, std::string_view separator) {
    if (text.starts_with('+') || text.starts_with('-')) text.remove_prefix(1);
    std::size_t groups = 0;
    for (;; ++groups) {
        const std::size_t end = text.find(separator);
        const std::string_view group = text.substr(0, end);
        const bool fits = groups == 0 ? !group.empty() && group.size() <= 3 : group.size() == 3;
        if (!fits || !std::ranges::all_of(group, is_digit)) return false;
        if (end == std::string_view::npos) return groups > 0;
        text.remove_prefix(end + separator.size());
    }
}

/// A number as the format has it, read from one that is written otherwise.
struct PlainNumber {
    std::string digits;
    std::string how;  // the rest of the sentence
};

/// The only sensible readings of a number with commas, or with separators of thousands; nothing if there is
/// none. A part after the separators may be a fraction with point or comma.
std::optional<PlainNumber> reading_of(std::string_view text) {
    for (const std::string_view separator : thousands) {
        if (text.find(separator) == std::string_view::npos) continue;
        const char* rest = separator == "," ? ".eE" : separator == "." ? ",eE" : ".,eE";
        const std::size_t end = text.find_first_of(rest);
        if (!is_grouped(text.substr(0, end), separator)) continue;
        std::string plain = replaced(text.substr(0, end), separator, "");
        if (end != std::string_view::npos) plain += replaced(text.substr(end), ",", ".");
        if (!parse_number(plain)) continue;
        const std::string decimal = replaced(text, ",", ".");
        const bool may_be_decimal = separator == "," && parse_number(decimal);
        const std::size_t digit = text.find_first_of("0123456789");
        if (may_be_decimal && text[digit] == '0') continue;  // 0,125 has no thousands
        return PlainNumber{plain,
                           " without separators of thousands" +
                               (may_be_decimal ? ", or " + decimal + " if the comma is a decimal one" : "")};
    }
    const std::string with_point = replaced(text, ",", ".");
    if (with_point != text && parse_number(with_point))
        return PlainNumber{with_point, " with a decimal point, and no separators of thousands"};
    return std::nullopt;
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
    const std::string nothing_better = "write a number such as 0.0125";
    if (text.size() > 40) return nothing_better;
    const std::string minus_sign =
        replaced(text, "\xe2\x88\x92", "-");  // U+2212, as typesetting programs write it
    if (parse_number(minus_sign)) return "write " + minus_sign + " with a plain hyphen as minus sign";
    if (const auto reading = reading_of(text)) return "write " + reading->digits + reading->how;
    const std::size_t end = end_of_number(text);
    if (end == 0 || !begins_unit(trimmed_at_start(text.substr(end)))) return nothing_better;
    const std::string number(trimmed(text.substr(0, end))), unit(trimmed_at_start(text.substr(end)));
    const auto reading = reading_of(number);
    if (!parse_number(number) && !reading) return nothing_better;
    const std::string right =
        reading ? "write " + reading->digits + reading->how : "write " + number + " alone";
    if (unit == "%") return right + ", leave out the percent sign and end the name with _percent";
    return right + (reading ? ", alone if '" : " if '") + shown(unit) +
           "' is a unit, which belongs in the name";
}

}  // namespace loam::lab_data
