#include "experiments/lab_tests/registry.hpp"

#include <array>

#include "experiments/lab_tests/oedometer.hpp"
#include "experiments/lab_tests/triaxial.hpp"

namespace loam::experiments {
namespace {

constexpr std::array oedometer_channels{TestChannel{"axial_strain", "m/m"}};
constexpr std::array triaxial_channels{TestChannel{"deviatoric_stress", "Pa"},
                                       TestChannel{"volumetric_strain", "m/m"}};

const std::array table{
    LabTestKind{lab_data::TestKind::oedometer,
                "zero lateral strain, axial stress in stages, unloading where measured", "axial_stress", "Pa",
                true, oedometer_channels, oedometer_readings, run_measured_oedometer, picture_of_oedometer},
    LabTestKind{lab_data::TestKind::triaxial,
                "drained: isotropic consolidation, then axial compression at constant lateral stress",
                "axial_strain", "m/m", false, triaxial_channels, triaxial_readings, run_measured_triaxial,
                picture_of_triaxial},
};

}  // namespace

std::span<const LabTestKind> lab_test_kinds() {
    return table;
}

std::vector<OutputColumn> output_columns(const LabTestKind& kind, const lab_data::Test& test) {
    const auto stored = [](std::string_view unit) { return unit == "m/m" ? "" : std::string(unit); };
    std::vector<OutputColumn> columns;
    for (const TestChannel& channel : kind.channels)
        for (const std::size_t k : kind.readings(test))
            columns.push_back({test.file, std::string(channel.name), stored(channel.unit),
                               std::string(kind.x_name), stored(kind.x_unit),
                               test.column(std::string(kind.x_name))[k]});
    return columns;
}

const LabTestKind* find_lab_test(lab_data::TestKind kind) {
    for (const LabTestKind& entry : table)
        if (entry.kind == kind) return &entry;
    return nullptr;
}

}  // namespace loam::experiments
