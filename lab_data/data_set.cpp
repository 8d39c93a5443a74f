#include "lab_data/data_set.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "lab_data/curve.hpp"
#include "lab_data/gather.hpp"
#include "lab_data/nearest_name.hpp"
#include "lab_data/number.hpp"
#include "lab_data/shown.hpp"
#include "lab_data/test_settings.hpp"
#include "lab_data/text_file.hpp"
#include "lab_data/units.hpp"

namespace loam::lab_data {
namespace fs = std::filesystem;
namespace {

constexpr std::array<std::string_view, 9> set_keys{"name",    "kind",        "source",
                                                   "licence", "description", "measured",
                                                   "notes",   "attribution", "seating_stress_kPa"};

bool is_missing(std::string_view cell) {
    constexpr std::array<std::string_view, 7> marks{"", "-", "NA", "N/A", "n/a", "NaN", "nan"};
    return std::ranges::find(marks, trimmed(cell)) != marks.end();
}

/// samples.csv with the data set's part of dataset.toml.
struct Rows {
    const CsvTable& table;
    const DataSet& set;
    std::optional<double> seating_stress;  // kPa

    std::optional<std::size_t> column(std::string_view name) const {
        const auto found = std::ranges::find(table.header, name);
        if (found == table.header.end()) return std::nullopt;
        return static_cast<std::size_t>(found - table.header.begin());
    }
};

void read_kind(const TomlTable& root, DataSet& set, Faults& faults) {
    const std::string kind =
        root.needed_text("kind", "write kind = \"oedometer\", \"triaxial\" or \"direct_shear\"");
    if (kind.empty()) return;
    if (const auto found = kind_of_name(kind)) {
        set.kind = *found;
        return;
    }
    Fault fault = root.at("kind");
    fault.constraint = "is no kind of test";
    fault.remedy = suggest_name(kind, kind_names());
    faults.error(fault);
}

/// The stress for all samples, after its range and its fitness for the kind have been checked.
std::optional<double> read_seating_stress(const TomlTable& root, const DataSet& set, Faults& faults) {
    const auto value = root.number("seating_stress_kPa");
    if (!value) return std::nullopt;
    Fault fault = root.at("seating_stress_kPa");
    if (set.kind != TestKind::oedometer) {
        fault.constraint = "does not belong to a data set of kind " + std::string(to_string(set.kind));
        fault.remedy = "remove it";
        faults.error(fault);
        return std::nullopt;
    }
    Test scratch;
    const auto setting =
        std::ranges::find(settings(), std::string_view("seating_stress_kPa"), &Setting::name);
    apply_setting(*setting, *value, scratch, fault, faults);
    return value;
}

/// The columns that must be there, and names given twice.
void check_structure(const Rows& rows, Faults& faults) {
    std::vector<std::string_view> needed{"sample", "file"};
    for (const Setting& setting : settings())
        if (setting.required && setting.applies_to(rows.set.kind)) needed.push_back(setting.name);
    const std::vector<std::string_view> header(rows.table.header.begin(), rows.table.header.end());
    for (const std::string_view name : needed) {
        if (rows.column(name)) continue;
        const auto near = nearest_quantity(name, header);
        faults.error(
            {.file = rows.table.file,
             .line = rows.table.header_line,
             .column = std::string(name),
             .constraint = "is missing",
             .remedy = near ? "did you mean column '" + shown(*near) + "'? If so, " + renaming(*near, name)
                            : "add the column, with a value for each sample"});
    }
    for (const std::string_view name : {"sample", "file"}) {
        const auto index = rows.column(name);
        if (!index) continue;
        std::set<std::string_view> seen;
        RepeatedFault bad(faults, rows.table.file);
        for (std::size_t row = 0; row < rows.table.rows.size(); ++row) {
            const std::string& cell = rows.table.rows[row].cells[*index];
            if (!cell.empty() && seen.insert(cell).second) continue;
            Fault fault = rows.table.at(row, *index);
            fault.constraint = cell.empty() ? "is empty" : "is there twice";
            fault.remedy = "give each sample a name and a file of its own";
            bad.error(fault);
        }
    }
}

/// Says so if a column of labels was probably meant as numbers: most are, or would be with a decimal point.
void warn_of_labels(const CsvTable& table, std::size_t column, Faults& faults) {
    std::size_t present = 0, numbers = 0;
    std::optional<std::size_t> odd, comma;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        std::string cell = table.rows[row].cells[column];
        if (is_missing(cell)) continue;
        ++present;
        if (parse_number(cell)) {
            ++numbers;
            continue;
        }
        odd = row;
        std::ranges::replace(cell, ',', '.');
        if (parse_number(cell)) comma = row;
    }
    if (2 * numbers <= present && !comma) return;
    const std::size_t row = comma ? *comma : *odd;
    const std::string& cell = table.rows[row].cells[column];
    faults.warn(table.file + ":" + std::to_string(table.rows[row].line),
                "column '" + shown(table.header[column]) + "' is taken as labels, because '" + shown(cell) +
                    "' is not a number" + (comma ? "; " + number_remedy(cell) : ""));
}

/// A column's values: numbers if all that are there are numbers, else labels.
std::vector<Covariate> read_covariate(const CsvTable& table, std::size_t column, Faults& faults) {
    const bool numeric = std::ranges::all_of(table.rows, [&](const CsvRow& row) {
        return is_missing(row.cells[column]) || parse_number(row.cells[column]);
    });
    if (!numeric) warn_of_labels(table, column, faults);
    std::vector<Covariate> covariates(table.rows.size());
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const std::string& cell = table.rows[row].cells[column];
        if (is_missing(cell)) continue;
        if (numeric)
            covariates[row] = *parse_number(cell);
        else
            covariates[row] = cell;
    }
    return covariates;
}

void read_settings(const Rows& rows, std::size_t row, Test& test, Faults& faults) {
    const auto value_of = [&](std::string_view name, bool required) -> std::optional<double> {
        const auto column = rows.column(name);
        if (!column) return std::nullopt;
        const std::string& cell = rows.table.rows[row].cells[*column];
        const auto value = parse_number(cell);
        if (value || (is_missing(cell) && !required)) return value;
        Fault fault = rows.table.at(row, *column);
        fault.constraint = cell.empty() ? "is empty but must be a number" : "must be a number";
        fault.remedy = number_remedy(cell);
        faults.error(fault);
        return std::nullopt;
    };
    if (rows.seating_stress) test.seating_stress = *rows.seating_stress * 1e3;
    for (const Setting& setting : settings()) {
        if (!setting.applies_to(test.kind)) continue;
        if (const auto value = value_of(setting.name, setting.required))
            apply_setting(setting, *value, test, rows.table.at(row, *rows.column(setting.name)), faults);
    }
    complete_settings(test);
    if (const auto value = value_of("measurement_sd", false))
        apply_measurement_sd("", *value, test, rows.table.at(row, *rows.column("measurement_sd")), faults);
}

DataSetRow gather_row(const Rows& rows, std::size_t row, std::vector<std::string>& warnings) {
    const std::size_t file_column = *rows.column("file");
    DataSetRow result{.name = rows.table.rows[row].cells[*rows.column("sample")],
                      .file = rows.table.rows[row].cells[file_column],
                      .line = rows.table.rows[row].line,
                      .covariates = {},
                      .test = Test{},
                      .more_faults = {}};
    Faults faults;
    Test test;
    test.kind = rows.set.kind;
    test.file = result.file;
    read_settings(rows, row, test, faults);
    if (is_in_folder(rows.set.folder, result.file, rows.table.at(row, file_column), faults))
        read_curve(rows.set.folder / result.file, test, faults);
    warnings.insert(warnings.end(), faults.warnings.begin(), faults.warnings.end());
    if (faults.errors.empty()) {
        result.test = std::move(test);
    } else {
        result.test = faults.errors.front();
        result.more_faults.assign(faults.errors.begin() + 1, faults.errors.end());
    }
    return result;
}

/// A setting with a wrong letter would be a covariate, and every sample would have the default instead.
void warn_of_near_setting(const Rows& rows, const std::string& name, Faults& faults) {
    std::vector<std::string_view> valid{"measurement_sd"};
    for (const Setting& setting : settings())
        if (setting.applies_to(rows.set.kind)) valid.push_back(setting.name);
    const auto near = nearest_quantity(name, valid);
    if (near && *near != name && !rows.column(*near))
        faults.warn(rows.table.file, "column '" + shown(name) + "' is taken as a covariate; did you mean '" +
                                         *near + "'? If so, " + renaming(name, *near));
}

void read_rows(const Rows& rows, DataSet& set, Faults& faults) {
    check_structure(rows, faults);
    if (!faults.errors.empty()) return;
    for (std::size_t row = 0; row < rows.table.rows.size(); ++row)
        set.rows.push_back(gather_row(rows, row, faults.warnings));
    for (std::size_t column = 0; column < rows.table.header.size(); ++column) {
        const std::string& name = rows.table.header[column];
        if (name.empty() || name == "sample" || name == "file") continue;
        warn_of_near_setting(rows, name, faults);
        set.covariates.push_back(name);
        auto covariates = read_covariate(rows.table, column, faults);
        for (std::size_t row = 0; row < set.rows.size(); ++row)
            set.rows[row].covariates.push_back(std::move(covariates[row]));
    }
}

}  // namespace

DataSet gather_data_set(const fs::path& path, Faults& faults) {
    DataSet set;
    const auto file = locate(path, data_set_file, faults);
    if (!file) return set;
    const auto parsed = parse_toml(*file, faults);
    if (!parsed) return set;
    set.folder = file->parent_path().empty() ? fs::path(".") : file->parent_path();
    const TomlTable root(*parsed, file->string(), 0, faults);
    root.allow_only(set_keys);
    read_identity(root, set, faults);
    read_kind(root, set, faults);
    const auto seating_stress = read_seating_stress(root, set, faults);
    if (const auto table = read_csv(set.folder / "samples.csv", faults))
        read_rows({*table, set, seating_stress}, set, faults);
    return set;
}

DataSet read_data_set(const fs::path& path) {
    Faults faults;
    DataSet set = gather_data_set(path, faults);
    if (!faults.errors.empty()) throw faults.errors.front();
    set.warnings = std::move(faults.warnings);
    return set;
}

}  // namespace loam::lab_data
