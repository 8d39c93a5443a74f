#include "lab_data/test_settings.hpp"

#include <algorithm>
#include <array>

#include "lab_data/faults.hpp"
#include "lab_data/nearest_name.hpp"

namespace loam::lab_data {
namespace {

constexpr std::array<std::string_view, 3> all_kinds{"oedometer", "triaxial", "direct_shear"};  // by TestKind

constexpr double largest_stress_kPa = 1e6;
constexpr double largest_size_mm = 1e5;

constexpr std::array all_settings{
    Setting{"initial_void_ratio", std::nullopt, false, 0, false, 30, 1, 1,
            [](Test& test, double value) { test.initial_void_ratio = value; },
            "give the volume of pores over that of grains, such as 0.65"},
    Setting{"seating_stress_kPa", TestKind::oedometer, false, 0, false, largest_stress_kPa, 1e3, 1,
            [](Test& test, double value) { test.seating_stress = value; },
            "give the stress where strain is zero, such as 2, or leave it out"},
    Setting{"cell_pressure_kPa", TestKind::triaxial, true, 0, false, largest_stress_kPa, 1e3, 1,
            [](Test& test, double value) { test.cell_pressure = value; },
            "give the effective cell pressure in kPa, such as cell_pressure_kPa = 100"},
    Setting{"normal_stress_kPa", TestKind::direct_shear, true, 0, false, largest_stress_kPa, 1e3, 1,
            [](Test& test, double value) { test.normal_stress = value; },
            "give the normal stress in kPa, such as normal_stress_kPa = 100"},
    Setting{"box_length_mm", TestKind::direct_shear, true, 0, false, largest_size_mm, 1, 1e3,
            [](Test& test, double value) { test.box_length = value; },
            "give the shear box's length in mm, such as box_length_mm = 60"},
    Setting{
        "box_width_mm", TestKind::direct_shear, false, 0, false, largest_size_mm, 1, 1e3,
        [](Test& test, double value) { test.box_width = value; },
        "give the shear box's width in mm, such as box_width_mm = 60, or leave it out if it is the length"},
    Setting{"box_height_mm", TestKind::direct_shear, true, 0, false, largest_size_mm, 1, 1e3,
            [](Test& test, double value) { test.box_height = value; },
            "give the specimen's height at the start of shearing in mm, such as box_height_mm = 25"},
    Setting{"wall_friction_angle_rad", TestKind::direct_shear, false, 0, true, 1.57, 1, 1,
            [](Test& test, double value) { test.wall_friction_angle = value; },
            "give it in radians: 20 degrees are 0.349"},
};

struct Channel {
    TestKind kind;
    Quantity quantity;
    double upper;  // of its standard deviation, SI
};

constexpr double largest_strain_sd = 0.1;
constexpr double largest_stress_sd = 1e8;

constexpr std::array channels{
    Channel{TestKind::oedometer, {"axial_strain", Dimension::ratio, true}, largest_strain_sd},
    Channel{TestKind::triaxial, {"deviatoric_stress", Dimension::stress, true}, largest_stress_sd},
    Channel{TestKind::triaxial, {"volumetric_strain", Dimension::ratio, true}, largest_strain_sd},
    Channel{TestKind::direct_shear, {"shear_stress", Dimension::stress, true}, largest_stress_sd},
    Channel{TestKind::direct_shear, {"settlement", Dimension::length, true}, 1.0},
};

std::string decimal(double value) {
    std::string text = std::to_string(value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) text.pop_back();
    return text;
}

}  // namespace

std::string_view to_string(TestKind kind) {
    return all_kinds[static_cast<std::size_t>(kind)];
}

std::span<const std::string_view> kind_names() {
    return all_kinds;
}

std::optional<TestKind> kind_of_name(std::string_view name) {
    const auto found = std::ranges::find(all_kinds, name);
    if (found == all_kinds.end()) return std::nullopt;
    return static_cast<TestKind>(found - all_kinds.begin());
}

std::span<const Setting> settings() {
    return all_settings;
}

void apply_setting(const Setting& setting, double value, Test& test, const Fault& where, Faults& faults) {
    const bool too_low = setting.lower_allowed ? value < setting.lower : value <= setting.lower;
    if (!too_low && value <= setting.upper) {
        setting.set(test, value * setting.multiply / setting.divide);
        return;
    }
    Fault fault = where;
    fault.constraint = std::string(setting.lower_allowed ? "must be at least " : "must be above ") +
                       decimal(setting.lower) + " and at most " + decimal(setting.upper);
    fault.remedy = setting.remedy;
    faults.error(fault);
}

void apply_measurement_sd(std::string_view name, double value, Test& test, const Fault& where,
                          Faults& faults) {
    std::vector<Quantity> quantities;
    std::string choices;
    for (const Channel& channel : channels) {
        if (channel.kind != test.kind) continue;
        quantities.push_back(channel.quantity);
        choices += (choices.empty() ? "" : "; ") + names_with_units(channel.quantity);
    }
    Fault fault = where;
    const auto named = name.empty() && quantities.size() == 1
                           ? parse_name(quantities.front().name, quantities)  // a ratio needs no unit
                           : parse_name(name, quantities);
    if (!named) {
        fault.constraint = name.empty() ? "must say which channel it is of, as this test has several"
                                        : "is no channel of this test, with its unit";
        fault.remedy = "write measurement_sd = {CHANNEL = NUMBER, ...}; channels are " + choices;
        faults.error(fault);
        return;
    }
    const auto channel = std::ranges::find_if(channels, [&](const Channel& candidate) {
        return candidate.kind == test.kind && candidate.quantity.name == named->quantity->name;
    });
    if (test.measurement_sd.contains(std::string(named->quantity->name))) {
        fault.constraint = "is of a channel that has one already";
        fault.remedy = "give one standard deviation for each channel";
        faults.error(fault);
        return;
    }
    const double si = named->unit->to_si(value);
    if (si > 0 && si <= channel->upper) {
        test.measurement_sd[std::string(named->quantity->name)] = si;
        return;
    }
    fault.constraint = "must be above 0 and at most " + decimal(channel->upper) + " in SI";
    fault.remedy = "give the standard deviation of one reading, a strain as a ratio such as 0.0001";
    faults.error(fault);
}

void complete_settings(Test& test) {
    if (test.kind == TestKind::direct_shear && test.box_width == 0) test.box_width = test.box_length;
}

}  // namespace loam::lab_data
