#include "lab_data/columns.hpp"

#include <algorithm>
#include <array>

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

// Endings that can only be meant as units; other endings make another quantity of an optional one.
constexpr std::array<std::string_view, 22> foreign_units{
    "psi", "ksi", "psf", "tsf", "bar", "mbar", "atm",  "hPa", "GPa", "kN",   "N",
    "kgf", "cm",  "dm",  "um",  "nm",  "in",   "inch", "ft",  "pct", "perc", "percents"};

std::string joined(std::string_view quantity, std::string_view unit) {
    return std::string(quantity) + (unit.empty() ? "" : "_") + std::string(unit);
}

bool is_foreign_unit(std::string_view text) {
    const auto same = [&](std::string_view unit) { return edit_distance(text, unit) == 0; };
    if (std::ranges::any_of(foreign_units, same)) return true;
    std::array<std::string_view, all_units.size()> suffixes{};
    for (std::size_t i = 0; i < all_units.size(); ++i) suffixes[i] = all_units[i].suffix;
    const auto nearest = nearest_name(text, suffixes);  // another letter case, or a slip
    return nearest && !nearest->empty();
}

std::string nearest_unit_name(const Quantity& quantity, std::string_view unit) {
    std::vector<std::string_view> suffixes;
    for (const Unit& known : all_units)
        if (known.dimension == quantity.dimension && !known.suffix.empty()) suffixes.push_back(known.suffix);
    const auto nearest = nearest_name(unit, suffixes);
    return nearest ? joined(quantity.name, *nearest) : std::string();
}

std::vector<std::string> full_names(const Quantity& quantity) {
    std::vector<std::string> names;
    for (const Unit& unit : all_units)
        if (unit.dimension == quantity.dimension) names.push_back(joined(quantity.name, unit.suffix));
    return names;
}

/// Of the names that are still free, the one most like any way to write the quantity; and what it should be.
std::optional<std::pair<std::string, std::string>> likely_meant(const Quantity& quantity,
                                                                std::span<const std::string> free_names) {
    const std::vector<std::string> valid = full_names(quantity);
    const std::vector<std::string_view> views(valid.begin(), valid.end());
    std::optional<std::pair<std::string, std::string>> best;
    for (const std::string& name : free_names) {
        const auto near = nearest_name(name, views);
        if (near && (!best || edit_distance(name, *near) < edit_distance(best->first, best->second)))
            best = {name, *near};
    }
    return best;
}

/// Which columns stand for which quantity, and what has been said of the others.
struct Assignment {
    const CsvTable& table;
    std::span<const Quantity> quantities;
    Faults& faults;
    std::map<std::string, Column> found;
    std::vector<std::string> free_names;      // columns that stand for nothing
    std::vector<std::string> explained = {};  // missing quantities for which a wrong unit has been reported

    bool has(std::string_view quantity) const { return found.contains(std::string(quantity)); }

    Fault at_header(std::string_view column) const {
        return {.file = table.file, .line = table.header_line, .column = std::string(column)};
    }

    void report_twice(std::size_t index, const Column& other) {
        Fault fault = at_header(table.header[index]);
        fault.constraint = "gives the same quantity as column '" + table.header[other.index] + "'";
        fault.remedy = "keep one of the two";
        faults.error(fault);
    }

    void assign() {
        for (std::size_t i = 0; i < table.header.size(); ++i) {
            if (const auto named = parse_name(table.header[i], quantities)) {
                const auto [other, added] =
                    found.try_emplace(std::string(named->quantity->name), Column{i, named->unit});
                if (!added) report_twice(i, other->second);
            } else if (!table.header[i].empty()) {
                free_names.push_back(table.header[i]);
            }
        }
        for (const Quantity& quantity : quantities)
            if (has(quantity.name) && has(quantity.instead_of))
                report_twice(found.at(std::string(quantity.name)).index,
                             found.at(std::string(quantity.instead_of)));
    }

    void report_wrong_units() {
        for (const std::string& name : free_names) {
            Fault fault = at_header(name);
            const Quantity* quantity = wrong_unit(name, quantities, fault);
            if (!quantity || has(quantity->name)) continue;
            faults.error(fault);
            explained.emplace_back(quantity->instead_of.empty() ? quantity->name : quantity->instead_of);
        }
    }

    void report_missing(const Quantity& quantity) {
        Fault fault = at_header(quantity.name);
        fault.constraint = "is missing";
        if (const auto meant = likely_meant(quantity, free_names)) {
            fault.remedy = "did you mean column '" + meant->first + "'? Name it '" + meant->second + "'";
        } else {
            fault.remedy = "add it as " + names_with_units(quantity);
            for (const Quantity& other : quantities)
                if (other.instead_of == quantity.name) fault.remedy += ", or else " + names_with_units(other);
            if (table.header.size() == 1)
                fault.remedy += "; columns are separated by comma, semicolon or tab";
        }
        faults.error(fault);
    }

    void report_absent() {
        for (const Quantity& quantity : quantities) {
            const auto replaces = [&](const Quantity& other) {
                return other.instead_of == quantity.name && has(other.name);
            };
            if (has(quantity.name) || std::ranges::find(explained, quantity.name) != explained.end())
                continue;
            if (quantity.required && !std::ranges::any_of(quantities, replaces)) report_missing(quantity);
            if (quantity.required || !quantity.instead_of.empty()) continue;
            if (const auto meant = likely_meant(quantity, free_names))
                faults.warn(table.file, "column '" + meant->first + "' is ignored; did you mean '" +
                                            meant->second + "'?");
        }
    }
};

}  // namespace

std::string names_with_units(const Quantity& quantity) {
    const std::vector<std::string> names = full_names(quantity);
    std::string text = names.front();
    for (std::size_t i = 1; i < names.size(); ++i) text += (i + 1 < names.size() ? ", " : " or ") + names[i];
    return text;
}

std::optional<NamedQuantity> parse_name(std::string_view name, std::span<const Quantity> quantities) {
    for (const Quantity& quantity : quantities)
        for (const Unit& unit : all_units)
            if (unit.dimension == quantity.dimension && name == joined(quantity.name, unit.suffix))
                return NamedQuantity{&quantity, &unit};
    return std::nullopt;
}

const Quantity* wrong_unit(std::string_view name, std::span<const Quantity> quantities, Fault& fault) {
    for (const Quantity& quantity : quantities) {
        if (quantity.dimension == Dimension::label || !name.starts_with(quantity.name)) continue;
        std::string_view rest = name.substr(quantity.name.size());
        if (rest.empty()) {
            fault.constraint = "has no unit";
            fault.remedy = "name it " + names_with_units(quantity);
        } else if (rest.starts_with('_') && rest.size() > 1 && rest.find('_', 1) == std::string_view::npos) {
            rest.remove_prefix(1);
            const auto same = [&](const Unit& unit) { return unit.suffix == rest; };
            const bool known = std::ranges::any_of(all_units, same);
            if (!known && !quantity.required && quantity.instead_of.empty() && !is_foreign_unit(rest))
                continue;
            fault.constraint = "has the unit '" + std::string(rest) + "', which " +
                               (known ? "does not fit the quantity" : "is not known");
            const std::string nearest = known ? "" : nearest_unit_name(quantity, rest);
            fault.remedy = nearest.empty() ? "" : "did you mean '" + nearest + "'? ";
            fault.remedy += "convert it and name it " + names_with_units(quantity);
        } else {
            continue;
        }
        fault.column = std::string(name);
        return &quantity;
    }
    return nullptr;
}

std::map<std::string, Column> find_columns(const CsvTable& table, std::span<const Quantity> quantities,
                                           Faults& faults) {
    Assignment assignment{
        .table = table, .quantities = quantities, .faults = faults, .found = {}, .free_names = {}};
    assignment.assign();
    assignment.report_wrong_units();
    assignment.report_absent();
    return std::move(assignment.found);
}

std::optional<std::vector<double>> read_numbers(const CsvTable& table, const Column& column, Faults& faults) {
    RepeatedFault bad(faults, table.file + ": column '" + table.header[column.index] + "'");
    std::vector<double> numbers;
    numbers.reserve(table.rows.size());
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const std::string& cell = table.rows[row].cells[column.index];
        if (const auto number = parse_number(cell)) {
            numbers.push_back(column.unit->to_si(*number));
            continue;
        }
        Fault fault = table.at(row, column.index);
        fault.constraint = cell.empty() ? "is empty but must be a number" : "must be a number";
        fault.remedy = number_remedy(cell);
        bad.error(fault);
    }
    if (bad.count() > 0) return std::nullopt;
    return numbers;
}

}  // namespace loam::lab_data
