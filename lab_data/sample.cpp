#include "lab_data/sample.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "lab_data/curve.hpp"
#include "lab_data/gather.hpp"
#include "lab_data/nearest_name.hpp"
#include "lab_data/test_settings.hpp"
#include "lab_data/text_file.hpp"
#include "lab_data/units.hpp"

namespace loam::lab_data {
namespace fs = std::filesystem;
namespace {

constexpr std::array<std::string_view, 9> sample_keys{"name",  "description", "source", "licence", "measured",
                                                      "notes", "attribution", "soil",   "test"};
constexpr std::array<std::string_view, 3> soil_keys{"grain_density_kg_m3", "grading", "properties"};
constexpr double least_density = 500, largest_density = 20000;

constexpr double usual_seating_stress = 2e3;  // Pa

void read_density(const TomlTable& soil, Sample& sample, Faults& faults) {
    constexpr std::string_view key = "grain_density_kg_m3";
    const std::string remedy = "give the density of the grains in kg/m3: 2650 for quartz";
    if (!soil.has(key)) return soil.missing(key, remedy);
    const auto density = soil.number(key);
    if (!density) return;
    sample.grain_density = *density;
    if (*density >= least_density && *density <= largest_density) return;
    Fault fault = soil.at(key);
    fault.constraint = "must be from 500 to 20000";
    fault.remedy = remedy;
    faults.error(fault);
}

void read_properties(const toml::table& properties, const std::string& file, Sample& sample, Faults& faults) {
    for (const auto& [key, value] : properties) {
        const std::string name(key.str());
        if (const auto number = number_of(value))
            sample.properties[name] = *number;
        else if (const auto label = value.value_exact<std::string>())
            sample.properties[name] = *label;
        else
            faults.error({.file = file,
                          .line = line_of(value),
                          .column = name,
                          .value = value_text(value),
                          .constraint = "must be a finite number or a text",
                          .remedy = "write one number, or one label in double quotes"});
    }
}

void read_soil(const TomlTable& root, const fs::path& path, Sample& sample, Faults& faults) {
    const std::string file = path.string();
    if (!root.has("soil"))
        return root.missing("soil", "add a line [soil] and under it grain_density_kg_m3 = 2650");
    const toml::table* table = root.subtable("soil");
    if (!table) return;
    const TomlTable soil(*table, file, line_of(*table), faults);
    soil.allow_only(soil_keys);
    read_density(soil, sample, faults);
    if (const toml::table* properties = soil.subtable("properties", "soil.properties"))
        read_properties(*properties, file, sample, faults);
    const std::string grading = soil.text("grading");
    if (soil.has("grading") && soil.node("grading")->is_string() &&
        is_in_folder(sample.folder, grading, soil.at("grading"), faults))
        sample.grading = read_grading(sample.folder / grading, faults);
}

void read_kind(const TomlTable& table, Test& test, bool& known, Faults& faults) {
    const std::string kind =
        table.needed_text("kind", "write kind = \"oedometer\", \"triaxial\" or \"direct_shear\"");
    const auto found = kind_of_name(kind);
    known = found.has_value();
    if (known) test.kind = *found;
    if (known || kind.empty()) return;
    Fault fault = table.at("kind");
    fault.constraint = "is no kind of test";
    fault.remedy = suggest_name(kind, kind_names());
    faults.error(fault);
}

void report_unknown_keys(const TomlTable& table, const Test& test, const std::string& file, Faults& faults) {
    std::vector<std::string_view> valid{"kind", "file", "measurement_sd"};
    for (const Setting& setting : settings())
        if (setting.applies_to(test.kind)) valid.push_back(setting.name);
    for (const auto& [key, value] : table.table()) {
        if (std::ranges::find(valid, key.str()) != valid.end()) continue;
        const auto other = std::ranges::find(settings(), key.str(), &Setting::name);
        const bool elsewhere = other != settings().end();
        faults.error({.file = file,
                      .line = static_cast<int>(key.source().begin.line),
                      .column = std::string(key.str()),
                      .constraint =
                          elsewhere ? "does not belong to a test of kind " + std::string(to_string(test.kind))
                                    : "is not known here",
                      .remedy = elsewhere ? "remove it, or correct the kind: it belongs to " +
                                                std::string(to_string(*other->kind))
                                          : suggest_key(key.str(), valid)});
    }
}

void read_settings(const TomlTable& table, const std::string& file, Test& test, Faults& faults) {
    for (const Setting& setting : settings()) {
        if (!setting.applies_to(test.kind)) continue;
        if (!table.has(setting.name)) {
            if (setting.required) table.missing(setting.name, std::string(setting.remedy));
        } else if (const auto value = table.number(setting.name)) {
            apply_setting(setting, *value, test, table.at(setting.name), faults);
        }
    }
    complete_settings(test);
    const toml::node* sd = table.node("measurement_sd");
    if (!sd) return;
    if (!sd->is_table()) {
        if (const auto value = table.number("measurement_sd"))
            apply_measurement_sd("", *value, test, table.at("measurement_sd"), faults);
        return;
    }
    const TomlTable channels(*sd->as_table(), file, line_of(*sd), faults);
    for (const auto& [key, node] : channels.table())
        if (const auto value = channels.number(key.str()))
            apply_measurement_sd(key.str(), *value, test, channels.at(key.str()), faults);
}

Test gather_test(const TomlTable& table, const fs::path& path, std::set<fs::path>& files, Faults& faults) {
    Test test;
    bool kind_known = false;
    read_kind(table, test, kind_known, faults);
    test.file = table.needed_text("file", "name the test's CSV file: file = \"oedometer.csv\"");
    if (kind_known) {  // else what belongs to it is not known either
        report_unknown_keys(table, test, path.string(), faults);
        read_settings(table, path.string(), test, faults);
    }
    if (test.file.empty() || !is_in_folder(path.parent_path(), test.file, table.at("file"), faults))
        return test;
    if (!files.insert(fs::path(test.file).lexically_normal()).second) {
        Fault fault = table.at("file");
        fault.constraint = "is the file of two tests";
        fault.remedy = "give each test its own file";
        faults.error(fault);
    } else if (kind_known) {
        read_curve(path.parent_path() / test.file, test, faults);
    }
    return test;
}

void read_tests(const TomlTable& root, const fs::path& path, Sample& sample, Faults& faults) {
    const std::string remedy = "begin each test with a line [[test]] and give its kind and file below";
    if (!root.has("test")) return root.missing("test", remedy);
    const toml::array* tests = root.node("test")->as_array();
    const auto is_table = [](const toml::node& node) { return node.is_table(); };
    if (!tests || tests->empty() || !std::all_of(tests->begin(), tests->end(), is_table)) {
        Fault fault = root.at("test");
        fault.value.clear();
        fault.constraint = "must be a list of tables";
        fault.remedy = remedy;
        return faults.error(fault);
    }
    std::set<fs::path> files;
    for (const toml::node& node : *tests) {
        const TomlTable table(*node.as_table(), path.string(), line_of(node), faults);
        sample.tests.push_back(gather_test(table, path, files, faults));
    }
}

}  // namespace

double seating_stress(const Test& test) {
    if (test.seating_stress) return *test.seating_stress;
    const double first = test.column("axial_stress").front();
    if (test.column("axial_strain").front() == 0) return first;
    return std::min(usual_seating_stress, first / 2);
}

Sample gather_sample(const fs::path& path, Faults& faults) {
    Sample sample;
    const auto file = locate(path, sample_file, faults);
    if (!file) return sample;
    const auto parsed = parse_toml(*file, faults);
    if (!parsed) return sample;
    sample.folder = file->parent_path().empty() ? fs::path(".") : file->parent_path();
    const TomlTable root(*parsed, file->string(), 0, faults);
    root.allow_only(sample_keys);
    read_identity(root, sample, faults);
    read_soil(root, *file, sample, faults);
    read_tests(root, *file, sample, faults);
    return sample;
}

Sample read_sample(const fs::path& path) {
    Faults faults;
    Sample sample = gather_sample(path, faults);
    if (!faults.errors.empty()) throw faults.errors.front();
    sample.warnings = std::move(faults.warnings);
    return sample;
}

}  // namespace loam::lab_data
