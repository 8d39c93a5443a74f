// One packing of the comparison with another DEM code, to 4 % strain, where a packing's own curve still
// repeats; all packings and cases to 20 % are in long/. Tolerances: the initial slope (to half the peak)
// within 10 %, the mean deviatoric stress over 2-4 % within 5 %, the volumetric strain within 1e-3.
#include "tests/verification/yade_triaxial.hpp"

namespace loam::experiments {
namespace {

TEST(YadeReferenceTriaxial, TheSamePackingGivesTheSameCurve) {
    constexpr int packing = 6;
    for (const YadeTriaxialCase& soil : yade_triaxial_cases()) {
        if (std::string(soil.name) != "free") continue;
        const TriaxialCurve reference = read_yade_triaxial(soil.name, packing);
        const TriaxialCurve ours = simulate_yade_triaxial(soil, packing, 0.04, soil.time_step_safety);
        EXPECT_NEAR(ours.initial_slope() / reference.initial_slope(), 1, 0.10);
        EXPECT_NEAR(ours.mean_stress(0.02, 0.04) / reference.mean_stress(0.02, 0.04), 1, 0.05);
        for (const double strain : {0.002, 0.005, 0.01, 0.02, 0.04})
            EXPECT_NEAR(ours.at(ours.volumetric, strain), reference.at(reference.volumetric, strain), 1e-3)
                << "at " << strain;
    }
}

}  // namespace
}  // namespace loam::experiments
