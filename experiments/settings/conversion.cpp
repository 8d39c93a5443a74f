#include "experiments/settings/conversion.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace loam::experiments {
namespace {

/// No error: the whole text is a number. result_out_of_range: it is, but one that the type cannot hold.
template <class Number>
std::errc parse(std::string_view text, Number& value) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    return stop == end && !text.empty() ? error : std::errc::invalid_argument;
}

template <class Number>
bool parse_whole(std::string_view text, Number& value) {
    return parse(text, value) == std::errc();
}

/// Assigns text to the value that a slot points to, by its type.
struct FromText {
    const Field& field;
    std::string_view text;
    const Origin& origin;

    void operator()(bool* slot) const {
        if (text != "true" && text != "false")
            throw fault_at(origin, std::string(text), "must be true or false", "");
        *slot = text == "true";
    }
    void operator()(int* slot) const { *slot = fitted<int>(integer_of(text, field, origin), field, origin); }
    void operator()(std::uint64_t* slot) const {
        *slot = fitted<std::uint64_t>(integer_of(text, field, origin), field, origin);
    }
    void operator()(double* slot) const { *slot = number_of(text, origin); }
    void operator()(std::optional<double>* slot) const { *slot = number_of(text, origin); }
    void operator()(std::string* slot) const { *slot = text; }
    void operator()(std::filesystem::path* slot) const {
        if (text.empty()) throw fault_at(origin, "", "needs a path", "");
        *slot = text;
    }
    void operator()(std::vector<std::string>* slot) const { *slot = list_of(text, origin); }
};

}  // namespace

lab_data::UserError fault_at(const Origin& origin, std::string value, std::string constraint,
                             std::string remedy) {
    return lab_data::UserError({.file = origin.file,
                                .line = origin.line,
                                .column = origin.name,
                                .value = std::move(value),
                                .constraint = std::move(constraint),
                                .remedy = std::move(remedy),
                                .position = origin.position});
}

double number_of(std::string_view text, const Origin& origin) {
    double value = 0;
    if (parse_whole(text, value) && std::isfinite(value)) return value;
    std::string pointed(text);
    std::ranges::replace(pointed, ',', '.');
    const bool comma = pointed != text && parse_whole(pointed, value);
    throw fault_at(origin, std::string(text), "must be a number",
                   comma ? "write " + pointed : "write it as 0.4 or 1.5e8");
}

std::int64_t integer_of(std::string_view text, const Field& field, const Origin& origin) {
    std::int64_t value = 0;
    const std::errc error = parse(text, value);
    if (error == std::errc()) return value;
    if (error == std::errc::result_out_of_range)
        throw fault_at(origin, std::string(text), "must be an integer and " + field.limits.text(), "");
    throw fault_at(origin, std::string(text), "must be an integer", "write it in digits, as 700");
}

std::vector<std::string> list_of(std::string_view text, const Origin& origin) {
    std::vector<std::string> items;
    for (std::size_t start = 0; start <= text.size();) {
        const std::size_t comma = std::min(text.find(',', start), text.size());
        items.emplace_back(text.substr(start, comma - start));
        if (items.back().empty())
            throw fault_at(origin, std::string(text), "has an empty item",
                           "separate the names by single commas, without blanks");
        start = comma + 1;
    }
    return items;
}

void assign_text(Settings& settings, const Field& field, std::string_view text, const Origin& origin) {
    std::visit(FromText{field, text, origin}, field.slot(settings));
}

std::filesystem::path based_on(const std::filesystem::path& folder, const std::filesystem::path& path) {
    return path.empty() ? path : (folder / path).lexically_normal();
}

}  // namespace loam::experiments
