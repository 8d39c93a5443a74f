#include "lab_data/columns.hpp"

#include <algorithm>

#include "lab_data/nearest_name.hpp"
#include "lab_data/number.hpp"
#include "lab_data/shown.hpp"

namespace loam::lab_data {
namespace {

std::string joined(std::string_view quantity, std::string_view unit) {
    return std::string(quantity) + (unit.empty() ? "" : "_") + std::string(unit);
}

/// Whether an optional quantity followed by this can only be meant with a unit.
bool is_meant_as_unit(std::string_view text) {
    if (is_unit(text)) return true;
    std::vector<std::string_view> suffixes;
    for (const Unit& unit : known_units()) suffixes.push_back(unit.suffix);
    const auto nearest = nearest_name(text, suffixes);  // a slip
    return nearest && !nearest->empty();
}

std::string nearest_unit_name(const Quantity& quantity, std::string_view unit) {
    std::vector<std::string_view> suffixes;
    for (const Unit& known : known_units())
        if (known.dimension == quantity.dimension && !known.suffix.empty()) suffixes.push_back(known.suffix);
    const auto nearest = nearest_name(unit, suffixes);
    return nearest ? joined(quantity.name, *nearest) : std::string();
}

std::vector<std::string> full_names(const Quantity& quantity) {
    std::vector<std::string> names;
    for (const Unit& unit : known_units())
        if (unit.dimension == quantity.dimension) names.push_back(joined(quantity.name, unit.suffix));
    return names;
}

/// The quantity that a column may have been meant as, with the unit that its name states.
struct Meant {
    std::string column;
    const Quantity* quantity;
    std::string unit;  // as written; empty: none
    std::size_t distance;

    /// The right name, if its unit is known.
    std::optional<std::string> name() const {
        if (unit.empty() && quantity->dimension != Dimension::label) return std::nullopt;
        const Unit* known = spelt_unit(unit, quantity->dimension);
        return known ? std::optional(joined(quantity->name, known->suffix)) : std::nullopt;
    }
    /// How to name the column, as a sentence.
    std::string naming() const {
        if (const auto right = name()) return "Name it '" + *right + "'";
        if (!unit.empty())
            return "Its unit '" + shown(unit) + "' cannot be read: convert it and name it " +
                   names_with_units(*quantity);
        if (quantity->dimension == Dimension::ratio)
            return "Name it '" + std::string(quantity->name) + "' if it is a ratio, '" +
                   joined(quantity->name, "percent") + "' if it is in percent";
        return "Its name must state the unit: " + names_with_units(*quantity);
    }
};

/// Of the columns that are still free, the one most like the quantity's name, whatever its unit.
std::optional<Meant> likely_meant(const Quantity& quantity, std::span<const std::string> free_names) {
    std::optional<Meant> best;
    for (const std::string& column : free_names) {
        const WrittenName written = split_unit(column);
        const auto distance = quantity_distance(written.quantity, quantity.name);
        if (distance && (!best || *distance < best->distance))
            best = {column, &quantity, written.unit, *distance};
    }
    return best;
}

/// Whether the name is the quantity's followed by a wrong unit or none, where one is needed. Sets the fault's
/// column, constraint and remedy.
bool has_wrong_unit(std::string_view name, const Quantity& quantity, Fault& fault) {
    if (quantity.dimension == Dimension::label || !name.starts_with(quantity.name)) return false;
    std::string_view rest = name.substr(quantity.name.size());
    if (rest.empty()) {
        fault.constraint = "has no unit";
        fault.remedy = "name it " + names_with_units(quantity);
    } else if (rest.starts_with('_') && rest.size() > 1 && rest.find('_', 1) == std::string_view::npos) {
        rest.remove_prefix(1);
        const bool known = std::ranges::find(known_units(), rest, &Unit::suffix) != known_units().end();
        if (!known && !quantity.required && quantity.instead_of.empty() && !is_meant_as_unit(rest))
            return false;
        fault.constraint = "has the unit '" + shown(rest) + "', which " +
                           (known ? "does not fit the quantity" : "is not known");
        if (const Unit* spelt = spelt_unit(rest, quantity.dimension)) {
            fault.remedy = "did you mean '" + joined(quantity.name, spelt->suffix) + "'?";
        } else {
            const std::string nearest = known ? "" : nearest_unit_name(quantity, rest);
            fault.remedy = nearest.empty() ? "" : "did you mean '" + nearest + "'? Else ";
            fault.remedy += "convert it and name it " + names_with_units(quantity);
        }
    } else {
        return false;
    }
    fault.column = std::string(name);
    return true;
}

bool replaces(const Quantity& other, const Quantity& quantity) {
    return other.instead_of == quantity.name;
}

/// Which columns stand for which quantity, and what has been said of the others.
struct Assignment {
    const CsvTable& table;
    std::span<const Quantity> quantities;
    Faults& faults;
    std::map<std::string, Column> found;
    std::vector<std::string> free_names;      // columns that stand for nothing and have not been named yet
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
        const std::vector<std::string> names = free_names;
        for (const std::string& name : names) {
            Fault fault = at_header(name);
            const auto quantity = std::ranges::find_if(
                quantities, [&](const Quantity& known) { return has_wrong_unit(name, known, fault); });
            if (quantity == quantities.end() || has(quantity->name)) continue;
            faults.error(fault);
            explained.emplace_back(quantity->instead_of.empty() ? quantity->name : quantity->instead_of);
            std::erase(free_names, name);
        }
    }

    /// Takes the column that may be the quantity, so that it is offered for no other one.
    std::optional<Meant> take_meant(const Quantity& quantity) {
        auto meant = likely_meant(quantity, free_names);
        for (const Quantity& other : quantities) {
            if (!replaces(other, quantity)) continue;
            const auto instead = likely_meant(other, free_names);
            if (instead && (!meant || instead->distance < meant->distance)) meant = instead;
        }
        if (meant) std::erase(free_names, meant->column);
        return meant;
    }

    void report_missing(const Quantity& quantity) {
        Fault fault = at_header(quantity.name);
        fault.constraint = "is missing";
        if (const auto meant = take_meant(quantity)) {
            fault.remedy = "did you mean column '" + shown(meant->column) + "'? " + meant->naming();
        } else {
            fault.remedy = "add it as " + names_with_units(quantity);
            for (const Quantity& other : quantities)
                if (replaces(other, quantity)) fault.remedy += ", or else " + names_with_units(other);
            if (table.header.size() == 1)
                fault.remedy += "; columns are separated by comma, semicolon or tab";
        }
        faults.error(fault);
    }

    void warn_of_ignored(const Quantity& quantity) {
        const auto meant = take_meant(quantity);
        if (!meant) return;
        const auto right = meant->name();
        faults.warn(table.file, "column '" + shown(meant->column) + "' is ignored; did you mean '" +
                                    right.value_or(std::string(quantity.name)) + "'?" +
                                    (right ? "" : " " + meant->naming()));
    }

    bool is_absent(const Quantity& quantity) const {
        return !has(quantity.name) && std::ranges::find(explained, quantity.name) == explained.end();
    }

    /// The needed ones first, as the columns that they may be are not those of the others.
    void report_absent() {
        for (const Quantity& quantity : quantities) {
            const auto stands_for = [&](const Quantity& other) {
                return replaces(other, quantity) && has(other.name);
            };
            if (quantity.required && is_absent(quantity) && !std::ranges::any_of(quantities, stands_for))
                report_missing(quantity);
        }
        for (const Quantity& quantity : quantities)
            if (!quantity.required && quantity.instead_of.empty() && is_absent(quantity))
                warn_of_ignored(quantity);
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
        for (const Unit& unit : known_units())
            if (unit.dimension == quantity.dimension && name == joined(quantity.name, unit.suffix))
                return NamedQuantity{&quantity, &unit};
    return std::nullopt;
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
