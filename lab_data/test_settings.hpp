// The settings of a laboratory test: keys of [[test]] in sample.toml, columns of samples.csv in a data set.
// One table holds their names, units and ranges for both.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "lab_data/columns.hpp"
#include "lab_data/sample.hpp"

namespace loam::lab_data {

struct Faults;

struct Setting {
    std::string_view name;         // with unit
    std::optional<TestKind> kind;  // none: every kind has it
    bool required;
    double lower;  // in the unit of the name
    bool lower_allowed;
    double upper;             // allowed
    double multiply, divide;  // to SI
    void (*set)(Test&, double);
    std::string_view remedy;  // for what is missing or out of range

    bool applies_to(TestKind of) const { return !kind || *kind == of; }
};

/// All settings, in a fixed order.
std::span<const Setting> settings();

/// The kind of that name; nothing if there is none.
std::optional<TestKind> kind_of_name(std::string_view name);

/// The names of all kinds.
std::span<const std::string_view> kind_names();

/// Sets `setting` (which applies to the test's kind) to `value` in the unit of its name. `where` is the
/// value's place; a value out of range is reported there and not set.
void apply_setting(const Setting& setting, double value, Test& test, const Fault& where, Faults& faults);

/// Sets the standard deviation of channel `name` (with unit); for an empty name, of the test's only channel,
/// in SI. `where` as above. Reports an unknown channel, an ambiguous one, and a value out of range.
void apply_measurement_sd(std::string_view name, double value, Test& test, const Fault& where,
                          Faults& faults);

/// Settings that follow from others, once all are set: box_width from box_length.
void complete_settings(Test& test);

}  // namespace loam::lab_data
