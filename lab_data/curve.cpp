#include "lab_data/curve.hpp"

#include <algorithm>
#include <array>

#include "lab_data/columns.hpp"
#include "lab_data/csv_table.hpp"
#include "lab_data/curve_checks.hpp"
#include "lab_data/nearest_name.hpp"

namespace loam::lab_data {
namespace {

constexpr std::array oedometer_quantities{
    Quantity{"axial_stress", Dimension::stress, true}, Quantity{"axial_strain", Dimension::ratio, true},
    Quantity{"phase", Dimension::label, false},        Quantity{"lateral_stress", Dimension::stress, false},
    Quantity{"void_ratio", Dimension::ratio, false},
};
constexpr std::array triaxial_quantities{
    Quantity{"axial_strain", Dimension::ratio, true},
    Quantity{"deviatoric_stress", Dimension::stress, true},
    Quantity{"volumetric_strain", Dimension::ratio, true},
};
constexpr std::array direct_shear_quantities{
    Quantity{"shear_displacement", Dimension::length, true},
    Quantity{"shear_strain", Dimension::ratio, false, "shear_displacement"},
    Quantity{"shear_stress", Dimension::stress, true},
    Quantity{"settlement", Dimension::length, true},
    Quantity{"settlement_strain", Dimension::ratio, false, "settlement"},
    Quantity{"normal_stress", Dimension::stress, false},
};
constexpr std::array<std::string_view, 3> phases{"loading", "unloading", "reloading"};

std::span<const Quantity> quantities_of(TestKind kind) {
    switch (kind) {
        case TestKind::oedometer:
            return oedometer_quantities;
        case TestKind::triaxial:
            return triaxial_quantities;
        case TestKind::direct_shear:
            return direct_shear_quantities;
    }
    return {};
}

std::vector<std::string> read_labels(const CsvTable& table, std::size_t column) {
    std::vector<std::string> labels;
    labels.reserve(table.rows.size());
    for (const CsvRow& row : table.rows) labels.push_back(row.cells[column]);
    return labels;
}

std::vector<std::string> read_phases(const CsvTable& table, std::size_t column, Faults& faults) {
    RepeatedFault bad(faults, table.file + ": column 'phase'");
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        if (std::ranges::find(phases, table.rows[row].cells[column]) != phases.end()) continue;
        Fault fault = table.at(row, column);
        fault.constraint = (fault.value.empty() ? "is empty but must be " : "must be ") +
                           std::string("loading, unloading or reloading");
        fault.remedy = suggest_name(fault.value, phases);
        bad.error(fault);
    }
    return read_labels(table, column);
}

bool is_optional(const std::string& quantity, TestKind kind) {
    return std::ranges::any_of(quantities_of(kind), [&](const Quantity& known) {
        return known.name == quantity && !known.required && known.instead_of.empty();
    });
}

bool has_empty_cell(const CsvTable& table, std::size_t column) {
    return std::ranges::any_of(table.rows, [&](const CsvRow& row) { return row.cells[column].empty(); });
}

void fill_columns(const CsvTable& table, std::map<std::string, Column>& columns, Test& test, Faults& faults) {
    std::vector<bool> used(table.header.size(), false);
    for (auto entry = columns.begin(); entry != columns.end();) {
        const auto& [quantity, column] = *entry;
        if (quantity == "phase") {
            test.phase = read_phases(table, column.index, faults);
        } else if (is_optional(quantity, test.kind) && has_empty_cell(table, column.index)) {
            faults.warn(table.file,
                        "column '" + table.header[column.index] + "' has empty cells and is not used");
            entry = columns.erase(entry);
            continue;
        } else if (auto numbers = read_numbers(table, column, faults)) {
            test.columns[quantity] = std::move(*numbers);
        }
        used[column.index] = true;
        ++entry;
    }
    for (std::size_t i = 0; i < used.size(); ++i)
        if (!used[i]) test.other_columns[table.header[i]] = read_labels(table, i);
    for (const CsvRow& row : table.rows) test.lines.push_back(row.line);
}

/// A column given relative to a size of the box becomes a length.
void make_length(Test& test, const std::string& strain, const std::string& length, double size) {
    const auto found = test.columns.find(strain);
    if (found == test.columns.end()) return;
    for (double& value : found->second) value *= size;
    test.columns[length] = std::move(found->second);
    test.columns.erase(found);
}

}  // namespace

void read_curve(const std::filesystem::path& path, Test& test, Faults& faults) {
    const auto table = read_csv(path, faults);
    if (!table) return;
    const std::size_t faults_before = faults.errors.size();
    auto columns = find_columns(*table, quantities_of(test.kind), faults);
    fill_columns(*table, columns, test, faults);
    if (table->rows.size() < 2)
        faults.error({.file = table->file,
                      .line = table->rows.front().line,
                      .constraint = "is the only reading",
                      .remedy = "a curve needs two readings at least"});
    if (faults.errors.size() > faults_before) return;
    check_curve({*table, columns, test, faults});
    make_length(test, "shear_strain", "shear_displacement", test.box_length);
    make_length(test, "settlement_strain", "settlement", test.box_height);
}

}  // namespace loam::lab_data
