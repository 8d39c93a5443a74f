#include "lab_data/toml_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

#include "lab_data/number.hpp"
#include "lab_data/shown.hpp"
#include "lab_data/text_file.hpp"
#include "lab_data/units.hpp"

namespace loam::lab_data {
namespace {

constexpr std::size_t largest_toml = 256u << 10;
constexpr std::size_t longest_description = 300;  // the parser quotes keys in it

bool is_quote(char c) {
    return c == '"' || c == '\'';
}

bool is_key_byte(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || is_quote(c);
}

/// Where the quotes that open at `at` close on the same line; `at` itself if they do not.
std::size_t end_of_quotes(std::string_view text, std::size_t at) {
    for (std::size_t i = at + 1; i < text.size() && text[i] != '\n'; ++i) {
        if (text[i] == text[at]) return i;
        if (text[at] == '"' && text[i] == '\\') ++i;
    }
    return at;
}

/// The fewest digits that give the number back; nearly always what was written.
std::string shortest(double value) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return {digits.data(), end};
}

std::string line_text(std::string_view text, int line) {
    for (int i = 1; i < line; ++i) {
        const std::size_t end = text.find('\n');
        if (end == std::string_view::npos) return {};
        text.remove_prefix(end + 1);
    }
    return std::string(trimmed(text.substr(0, text.find('\n'))));
}

std::string syntax_remedy(std::string_view line, std::string_view description) {
    if (description.find("redefine") != std::string_view::npos) return "remove one of the two";
    const std::size_t equals = line.find('=');
    if (equals != std::string_view::npos) {
        const std::string_view value = trimmed(line.substr(equals + 1));
        if (value.empty()) return "write a value after the =";
        if (!parse_number(value) && value.find_first_not_of("+-.,0123456789 ") == std::string_view::npos)
            return number_remedy(value);
        if (value.front() != '"' && value.front() != '\'' && value.front() != '[' && value.front() != '{')
            return "enclose text in double quotes";
        if (std::count(value.begin(), value.end(), '"') % 2 == 1) return "close the double quotes";
    } else if (line.starts_with('[')) {
        return "write [name] for a table and [[test]] for each test";
    }
    return "write key = value, text in double quotes and numbers with a decimal point";
}

}  // namespace

std::optional<Fault> fault_of_deep_key(std::string_view text, const std::string& file) {
    constexpr int deepest_key = 16;
    int line = 1, dots = 0;
    char last = ' ';  // last byte that is no blank
    bool blank = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '\n') ++line;
        if (c == ' ' || c == '\t') {
            blank = true;
            continue;
        }
        if (is_quote(c)) i = end_of_quotes(text, i);  // a part of a key, whatever it holds
        const bool goes_on = (c == '.' && is_key_byte(last)) || (is_key_byte(c) && (last == '.' || !blank));
        dots = goes_on ? dots + (c == '.') : 0;
        if (dots >= deepest_key)
            return Fault{.file = file,
                         .line = line,
                         .constraint = "has a key of more than " + std::to_string(deepest_key) + " parts",
                         .remedy = "use the keys of the format, which have few parts"};
        last = c;
        blank = false;
    }
    return std::nullopt;
}

std::optional<toml::table> parse_toml(const std::filesystem::path& path, Faults& faults) {
    const auto text = read_text(path, largest_toml, faults);
    if (!text) return std::nullopt;
    if (auto fault = fault_of_deep_key(*text, path.string())) {
        faults.error(std::move(*fault));
        return std::nullopt;
    }
    try {
        return toml::parse(*text, path.string());
    } catch (const toml::parse_error& error) {
        const auto& begin = error.source().begin;
        std::string description(error.description());
        constexpr std::string_view opening = "Error while parsing ";
        if (description.starts_with(opening)) description.replace(0, opening.size(), "in ");
        const std::string line = line_text(*text, static_cast<int>(begin.line));
        faults.error({.file = path.string(),
                      .line = static_cast<int>(begin.line),
                      .value = line,
                      .constraint = "is not valid TOML (" + shown(description, longest_description) + ")",
                      .remedy = syntax_remedy(line, description),
                      .position = static_cast<int>(begin.column)});
        return std::nullopt;
    }
}

int line_of(const toml::node& node) {
    return static_cast<int>(node.source().begin.line);
}

std::string value_text(const toml::node& node) {
    if (const auto text = node.value_exact<std::string>()) return *text;
    if (const auto real = node.value_exact<double>()) return shortest(*real);
    std::ostringstream stream;
    node.visit([&](const auto& value) { stream << value; });
    return stream.str();
}

std::optional<double> number_of(const toml::node& node) {
    std::optional<double> number;
    if (const auto integer = node.value_exact<std::int64_t>()) number = static_cast<double>(*integer);
    if (const auto real = node.value_exact<double>()) number = *real;
    if (number && !std::isfinite(*number)) number.reset();
    return number;
}

Fault TomlTable::at(std::string_view key) const {
    Fault fault{.file = file_, .line = header_line_, .column = std::string(key)};
    if (const toml::node* value = table_.get(key)) {
        fault.line = line_of(*value);
        fault.value = value_text(*value);
    }
    return fault;
}

void TomlTable::missing(std::string_view key, const std::string& remedy) const {
    Fault fault = at(key);
    fault.constraint = "is missing";
    fault.remedy = remedy;
    faults_.error(fault);
}

void TomlTable::wrong_type(std::string_view key, const std::string& type, const std::string& remedy) const {
    Fault fault = at(key);
    fault.constraint = "must be " + type;
    fault.remedy = remedy;
    faults_.error(fault);
}

std::string TomlTable::text(std::string_view key) const {
    const toml::node* value = table_.get(key);
    if (!value) return {};
    if (const auto text = value->value_exact<std::string>()) return std::string(trimmed(*text));
    wrong_type(key, "a text", "enclose it in double quotes");
    return {};
}

std::string TomlTable::needed_text(std::string_view key, const std::string& remedy) const {
    if (!has(key)) {
        missing(key, remedy);
        return {};
    }
    const std::string result = text(key);
    if (result.empty() && table_.get(key)->is_string()) wrong_type(key, "a text that is not empty", remedy);
    return result;
}

std::optional<double> TomlTable::number(std::string_view key) const {
    const toml::node* value = table_.get(key);
    if (!value) return std::nullopt;
    const auto number = number_of(*value);
    if (number) return number;
    std::string remedy = "write a number such as 0.0125";
    if (const auto text = value->value_exact<std::string>())
        remedy = parse_number(*text) ? "leave the quotes out" : number_remedy(*text);
    wrong_type(key, "a finite number", remedy);
    return std::nullopt;
}

std::optional<bool> TomlTable::boolean(std::string_view key) const {
    const toml::node* value = table_.get(key);
    if (!value) return std::nullopt;
    if (const auto boolean = value->value_exact<bool>()) return boolean;
    wrong_type(key, "true or false", "write true or false without quotes");
    return std::nullopt;
}

const toml::table* TomlTable::subtable(std::string_view key, std::string_view path) const {
    const toml::node* value = table_.get(key);
    if (!value) return nullptr;
    if (const toml::table* table = value->as_table()) return table;
    wrong_type(
        key, "a table",
        "write [" + std::string(path.empty() ? key : path) + "] on a line of its own and its keys below");
    return nullptr;
}

void TomlTable::allow_only(std::span<const std::string_view> valid) const {
    for (const auto& [key, value] : table_) {
        if (std::ranges::find(valid, key.str()) != valid.end()) continue;
        faults_.error({.file = file_,
                       .line = static_cast<int>(key.source().begin.line),
                       .column = std::string(key.str()),
                       .constraint = "is not known here",
                       .remedy = suggest_key(key.str(), valid)});
    }
}

}  // namespace loam::lab_data
