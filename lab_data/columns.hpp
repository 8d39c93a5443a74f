// Finds the quantities of a table by the names of its columns, whose last part is the unit: axial_stress_kPa.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lab_data/csv_table.hpp"
#include "lab_data/units.hpp"

namespace loam::lab_data {

/// A quantity that a table may hold.
struct Quantity {
    std::string_view name;  // without unit
    Dimension dimension;
    bool required;
    std::string_view instead_of = {};  // the required quantity that this one may replace
};

/// All ways to name a quantity with its unit, as in "a_kPa, a_Pa or a_MPa".
std::string names_with_units(const Quantity& quantity);

/// A name taken apart into quantity and unit; nothing if it is no such name.
struct NamedQuantity {
    const Quantity* quantity;
    const Unit* unit;
};
std::optional<NamedQuantity> parse_name(std::string_view name, std::span<const Quantity> quantities);

struct Column {
    std::size_t index = 0;
    const Unit* unit = nullptr;
};

/// The columns of a table by quantity. Reports: a required quantity that is missing (with the column that may
/// have been meant), a wrong unit, the same quantity twice. Warns of unknown columns that are nearly an
/// optional one.
std::map<std::string, Column> find_columns(const CsvTable& table, std::span<const Quantity> quantities,
                                           Faults& faults);

/// The numbers of a column in SI. Reports every cell that is no number; gives nothing then.
std::optional<std::vector<double>> read_numbers(const CsvTable& table, const Column& column, Faults& faults);

}  // namespace loam::lab_data
