#include "experiments/diagnosis/next_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace loam::experiments {
namespace {

using lab_data::TestKind;

struct Telling {
    std::string_view effect, measurement;
};

// Mundane effects first: each is settled without a model.
constexpr std::array telling{
    Telling{"apparatus_compliance",
            "load the device with a steel dummy in place of the specimen, and take its deformation off"},
    Telling{"seating", "measure the strain on the specimen itself, with local gauges or by images"},
    Telling{"density_error",
            "determine the void ratio of the specimens again, from the dry mass after the test"},
    Telling{"wall_friction",
            "measure the force at the base of the ring, or repeat the oedometer in a lower ring"},
    Telling{"capillarity", "repeat one test on the same soil fully saturated, or oven-dry"},
    Telling{"cementation", "repeat one test on the same soil remoulded to the same void ratio"},
    Telling{"adhesion",
            "measure the unconfined compressive strength, or a triaxial test at a very low cell pressure"},
    Telling{"plastic_contact",
            "run an oedometer with an unloading and reloading loop at each of three stresses"},
    Telling{"hertzian_stiffness",
            "measure the shear-wave velocity at three isotropic stresses, for its power of the stress"},
};

}  // namespace

MeasuredTests measured_tests(std::span<const lab_data::Test> tests) {
    MeasuredTests out;
    for (const lab_data::Test& test : tests) {
        out.kinds.insert(test.kind);
        if (test.kind == TestKind::triaxial) out.pressures.push_back(test.cell_pressure);
        if (test.kind == TestKind::direct_shear) out.pressures.push_back(test.normal_stress);
        out.has_unloading =
            out.has_unloading || std::ranges::find(test.phase, "unloading") != test.phase.end();
    }
    return out;
}

std::string next_test(const std::vector<std::string>& effects, const MeasuredTests& measured) {
    if (effects.size() > 1)
        for (const Telling& row : telling)
            if (std::ranges::find(effects, row.effect) != effects.end()) return std::string(row.measurement);
    if (!measured.kinds.contains(TestKind::triaxial))
        return "run drained triaxial tests at two cell pressures, with volume change";
    if (!measured.kinds.contains(TestKind::oedometer) || !measured.has_unloading)
        return "run an oedometer with unloading";
    if (!measured.kinds.contains(TestKind::direct_shear))
        return "run direct shear tests at two normal stresses, with settlement";
    const double highest = *std::ranges::max_element(measured.pressures);
    return fmt::format("run a drained triaxial test at a cell pressure of {:.0f} kPa, beyond those measured",
                       2e-3 * highest);
}

}  // namespace loam::experiments
