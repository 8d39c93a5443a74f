#include "experiments/lab_tests/registry.hpp"

#include <array>

#include "experiments/lab_tests/oedometer.hpp"

namespace loam::experiments {
namespace {

const std::array table{
    LabTestKind{lab_data::TestKind::oedometer,
                "zero lateral strain, axial stress in stages, unloading where measured", oedometer_readings,
                oedometer_outputs, run_measured_oedometer, picture_of_oedometer},
};

}  // namespace

std::span<const LabTestKind> lab_test_kinds() {
    return table;
}

const LabTestKind* find_lab_test(lab_data::TestKind kind) {
    for (const LabTestKind& entry : table)
        if (entry.kind == kind) return &entry;
    return nullptr;
}

}  // namespace loam::experiments
