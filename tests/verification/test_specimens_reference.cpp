// Specimens that are made to a void ratio against packings of that void ratio that another DEM code made
// (data/yade/README.md, packings 5 to 7): loaded alike they must be as stiff, for contacts that a preparation
// has lost look like a softer soil.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "experiments/lab_tests/oedometer.hpp"
#include "experiments/specimens.hpp"

namespace loam::experiments {
namespace {

Eigen::VectorXd oedometer(const engine::Packing& packing) {
    engine::LinearCohesive law;
    law.young_modulus = 1e8;
    law.stiffness_ratio = 0.8;
    law.friction_angle = 0.2;
    law.normal_cohesion = law.shear_cohesion = 0;
    OedometerOptions options;
    options.stages = {15e3, 57e3, 224e3, 895e3, 57e3};
    engine::Simulation simulation(packing, law, {});
    const OedometerResult run = run_oedometer(simulation, law, options);
    EXPECT_TRUE(run.complete) << run.reason;
    return run.strain;
}

TEST(SpecimensReference, DenseSpecimensAreAsStiffAsThoseOfAnotherCode) {
    const std::string folder = std::string(LOAM_SOURCE_DIR) + "/tests/verification/data/yade/";
    Eigen::VectorXd theirs = Eigen::VectorXd::Zero(5), ours = theirs;
    for (const int number : {5, 6, 7}) {
        const engine::Packing packing = load_packing(folder + "packing_" + std::to_string(number) + ".csv");
        const SpecimenShape shape{static_cast<std::uint32_t>(packing.radii.size())};
        const auto made = specimen_pool().get({}, packing.porosity(), shape,
                                              static_cast<std::uint64_t>(number), StopToken{});
        EXPECT_NEAR(made->packing.porosity(), packing.porosity(), 2e-3);
        theirs += oedometer(packing) / 3;
        ours += oedometer(made->packing) / 3;
    }
    // Measured: 0.87, 1.00, 1.05, 1.04 and 1.10 times theirs, with packings that scatter by some 5 %;
    // specimens of soft particles gave 1.32, 1.26, 1.15, 1.10 and 1.27.
    const Eigen::VectorXd ratio = ours.cwiseQuotient(theirs);
    const std::vector<double> tolerances{0.2, 0.1, 0.1, 0.1, 0.2};
    for (Eigen::Index k = 0; k < 5; ++k)
        EXPECT_NEAR(ratio[k], 1, tolerances[static_cast<std::size_t>(k)]) << "stage " << k;
}

}  // namespace
}  // namespace loam::experiments
