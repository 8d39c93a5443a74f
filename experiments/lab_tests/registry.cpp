#include "experiments/lab_tests/registry.hpp"

#include <array>
#include <stdexcept>

#include "experiments/lab_tests/direct_shear.hpp"
#include "experiments/lab_tests/oedometer.hpp"
#include "experiments/lab_tests/triaxial.hpp"

namespace loam::experiments {
namespace {

constexpr std::array oedometer_channels{TestChannel{"axial_strain", "m/m"}};
constexpr std::array triaxial_channels{TestChannel{"deviatoric_stress", "Pa"},
                                       TestChannel{"volumetric_strain", "m/m"}};

constexpr std::array direct_shear_channels{TestChannel{"shear_stress", "Pa"}, TestChannel{"settlement", "m"}};

SpecimenShape periodic_cell(const Settings&, const lab_data::Sample&, const lab_data::Test&, double,
                            std::uint32_t particles) {
    return {particles};
}

const std::array table{
    LabTestKind{lab_data::TestKind::oedometer,
                "zero lateral strain, axial stress in stages, unloading where measured", "axial_stress", "Pa",
                true, oedometer_channels, oedometer_readings, periodic_cell, run_measured_oedometer,
                picture_of_oedometer},
    LabTestKind{lab_data::TestKind::triaxial,
                "drained: isotropic consolidation, then axial compression at constant lateral stress",
                "axial_strain", "m/m", false, triaxial_channels, triaxial_readings, triaxial_specimen,
                run_measured_triaxial, picture_of_triaxial},
    LabTestKind{lab_data::TestKind::direct_shear,
                "box of rigid walls in two halves: loading by a platen, then shear at constant normal stress",
                "shear_displacement", "m", false, direct_shear_channels, direct_shear_readings,
                direct_shear_specimen, run_measured_direct_shear, picture_of_direct_shear},
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

const LabTestKind& lab_test(lab_data::TestKind kind) {
    for (const LabTestKind& entry : table)
        if (entry.kind == kind) return entry;
    throw std::logic_error("a kind of test is missing from the table");
}

}  // namespace loam::experiments
