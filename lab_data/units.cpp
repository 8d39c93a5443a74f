#include "lab_data/units.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "lab_data/nearest_name.hpp"
#include "lab_data/number.hpp"

namespace loam::lab_data {
namespace {

constexpr std::array all_units{
    Unit{"kPa", Dimension::stress, 1e3, 1},    Unit{"Pa", Dimension::stress, 1, 1},
    Unit{"MPa", Dimension::stress, 1e6, 1},    Unit{"mm", Dimension::length, 1, 1e3},
    Unit{"m", Dimension::length, 1, 1},        Unit{"", Dimension::ratio, 1, 1},
    Unit{"percent", Dimension::ratio, 1, 100}, Unit{"", Dimension::label, 1, 1},
};

struct Spelling {
    std::string_view written;  // folded
    std::string_view suffix;
};
constexpr std::array spellings{
    Spelling{"%", "percent"},
    Spelling{"pct", "percent"},
    Spelling{"perc", "percent"},
    Spelling{"percents", "percent"},
    Spelling{"percentage", "percent"},
    Spelling{"kn_m2", "kPa"},
    Spelling{"mn_m2", "MPa"},
    Spelling{"n_mm2", "MPa"},
    Spelling{"n_m2", "Pa"},
    Spelling{"-", ""},
    Spelling{"1", ""},
    Spelling{"m_m", ""},
    Spelling{"mm_mm", ""},
};

// Folded, but for single letters. Other endings make another quantity.
constexpr std::array<std::string_view, 49> foreign_units{
    "psi",      "ksi",   "psf",      "tsf",         "bar",       "mbar",    "atm",    "hpa",    "gpa",
    "kn",       "N",     "kgf",      "cm",          "dm",        "um",      "nm",     "in",     "inch",
    "ft",       "kg",    "mn",       "km",          "\xc2\xb5m", "feet",    "inches", "kg_cm2", "kgf_cm2",
    "t_m2",     "n_cm2", "lb_ft2",   "lb_in2",      "lbf_ft2",   "lbf_in2", "g_cm3",  "kg_m3",  "t_m3",
    "kn_m3",    "kg_l",  "g_ml",     "g_cc",        "rad",       "mrad",    "deg",    "degree", "degrees",
    "\xc2\xb0", "g",     "permille", "\xe2\x80\xb0"};

bool is_letter_or_digit(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           static_cast<unsigned char>(c) >= 0x80;
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

/// Units that differ in spelling alone become the same: "kN/m²" and "kn_m^2" are "kn_m2".
std::string folded_unit(std::string_view text) {
    std::string folded(trimmed(text));
    replace_all(folded, "\xc2\xb2", "2");
    replace_all(folded, "\xc2\xb3", "3");
    std::erase_if(folded, [](char c) { return c == ' ' || c == '^' || c == '.'; });
    for (char& c : folded) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
        if (c == '/') c = '_';
    }
    return folded;
}

std::string canonical_unit(std::string_view text) {
    const std::string folded = folded_unit(text);
    for (const Spelling& spelling : spellings)
        if (spelling.written == folded) return folded_unit(spelling.suffix);
    return folded;
}

/// Words of a name in small letters.
std::vector<std::string> words_of(std::string_view name) {
    std::vector<std::string> words;
    bool begins = true;
    for (const char c : name) {
        if (!is_letter_or_digit(c)) {
            begins = true;
            continue;
        }
        if (begins) words.emplace_back();
        begins = false;
        words.back() += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return words;
}

std::string without_separators_at_end(std::string_view text) {
    const std::size_t last = text.find_last_not_of(" \t\n\r_-/,:;");
    return std::string(text.substr(0, last == std::string_view::npos ? 0 : last + 1));
}

/// "stress (kPa)" and "stress [kPa]"; nothing if the name does not end so.
std::optional<WrittenName> split_bracket(std::string_view name) {
    if (!name.ends_with(')') && !name.ends_with(']')) return std::nullopt;
    const std::size_t open = name.rfind(name.back() == ')' ? '(' : '[');
    if (open == std::string_view::npos || open == 0) return std::nullopt;
    const std::string_view inside = name.substr(open + 1, name.size() - open - 2);
    return WrittenName{without_separators_at_end(name.substr(0, open)), std::string(trimmed(inside))};
}

constexpr std::size_t longest_split = 200;  // longer ones are no names of quantities

}  // namespace

std::span<const Unit> known_units() {
    return all_units;
}

const Unit* spelt_unit(std::string_view text, Dimension dimension) {
    const std::string folded = canonical_unit(text);
    const auto found = std::ranges::find_if(all_units, [&](const Unit& unit) {
        return unit.dimension == dimension && folded_unit(unit.suffix) == folded;
    });
    return found == all_units.end() ? nullptr : &*found;
}

bool is_unit(std::string_view text) {
    const std::string folded = folded_unit(text);
    if (folded.empty() || folded == "-" || folded == "1") return false;
    const auto known = [&](const Unit& unit) { return folded_unit(unit.suffix) == folded; };
    return std::ranges::any_of(all_units, known) ||
           std::ranges::find(spellings, folded, &Spelling::written) != spellings.end() ||
           std::ranges::find(foreign_units, text.size() > 1 ? std::string_view(folded) : text) !=
               foreign_units.end();
}

WrittenName split_unit(std::string_view name) {
    name = trimmed(name);
    if (name.size() > longest_split) return {std::string(name), {}};
    if (auto split = split_bracket(name)) return *split;
    for (std::size_t i = 1; i + 1 < name.size(); ++i) {  // the longest unit first: kg_m3, not m3
        if (is_letter_or_digit(name[i])) continue;
        const std::size_t begin = name[i] == '%' ? i : i + 1;
        if (is_unit(name.substr(begin)))
            return {without_separators_at_end(name.substr(0, i)), std::string(trimmed(name.substr(begin)))};
    }
    if (name.size() > 1 && name.ends_with('%'))
        return {without_separators_at_end(name.substr(0, name.size() - 1)), "%"};
    return {std::string(name), {}};
}

std::optional<std::size_t> quantity_distance(std::string_view a, std::string_view b) {
    if (a.size() > longest_split || b.size() > longest_split) return std::nullopt;
    const std::vector<std::string> words_a = words_of(a), words_b = words_of(b);
    std::string joined_a, joined_b;
    for (const std::string& word : words_a) joined_a += word;
    for (const std::string& word : words_b) joined_b += word;
    if (joined_a.empty() || joined_b.empty()) return std::nullopt;
    const std::size_t whole = edit_distance(joined_a, joined_b);
    if (words_a.size() != words_b.size())  // an underscore forgotten, and hardly anything else
        return whole <= std::max(joined_a.size(), joined_b.size()) / 6 ? std::optional(whole + 1)
                                                                       : std::nullopt;
    for (std::size_t i = 0; i < words_a.size(); ++i)
        if (edit_distance(words_a[i], words_b[i]) > std::max(words_a[i].size(), words_b[i].size()) / 3)
            return std::nullopt;
    return whole;
}

std::optional<std::string> nearest_quantity(std::string_view name, std::span<const std::string_view> valid) {
    const WrittenName written = split_unit(name);
    std::optional<std::string> nearest;
    std::size_t least = 0;
    for (const std::string_view candidate : valid) {
        const auto distance = quantity_distance(written.quantity, split_unit(candidate).quantity);
        if (!distance || (nearest && *distance >= least)) continue;
        nearest = std::string(candidate);
        least = *distance;
    }
    return nearest ? nearest : nearest_name(name, valid);
}

std::string renaming(std::string_view name, std::string_view valid) {
    const std::string from = split_unit(name).unit, to = split_unit(valid).unit;
    const std::string naming = "name it '" + std::string(valid) + "'";
    if (canonical_unit(from) == canonical_unit(to)) return naming;
    if (from.empty()) return naming + " if it is in " + to + ", else convert it to " + to + " first";
    return "convert it to " + (to.empty() ? "a number without unit" : to) + " and " + naming;
}

std::string suggest_key(std::string_view name, std::span<const std::string_view> valid) {
    const auto nearest = nearest_quantity(name, valid);
    if (!nearest) return suggest_name(name, valid);
    const std::string from = split_unit(name).unit, to = split_unit(*nearest).unit;
    const std::string question = "did you mean '" + *nearest + "'?";
    if (canonical_unit(from) == canonical_unit(to)) return question;
    if (from.empty()) return question + " Give it in " + to;
    return renaming(name, *nearest);
}

}  // namespace loam::lab_data
