// The packing generator: target met, reproducible, at rest, and honest where the target is out of reach.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/loading.hpp"
#include "engine/packing.hpp"
#include "engine/simulation.hpp"

namespace loam::engine {
namespace {

PackingOptions small(double porosity, std::uint64_t seed = 1) {
    PackingOptions options;
    options.particles = 300;
    options.target_porosity = porosity;
    options.seed = seed;
    return options;
}

TEST(Packing, MeetsTheTargetPorosity) {
    for (const double target : {0.47, 0.42, 0.38}) {
        const PackingResult made = make_packing(small(target));
        EXPECT_TRUE(made.reached) << made.stopped_by;
        // Counted anew from radii and cell: solid volume is the sum of 4/3 pi r^3.
        const double solid = 4.0 / 3 * 3.14159265358979 * made.packing.radii.array().pow(3).sum();
        EXPECT_NEAR(1 - solid / made.packing.cell.diagonal().prod(), target, 1e-3);
        EXPECT_NEAR(made.stress, 2000, 25);
    }
}

TEST(Packing, SaysWhereTheTargetIsOutOfReach) {
    const PackingResult loose = make_packing(small(0.599)), dense = make_packing(small(0.25));
    EXPECT_FALSE(loose.reached);
    EXPECT_GT(loose.porosity,
              0.48);  // spheres of high friction without rotation stay looser than random loose packing
    EXPECT_FALSE(dense.reached);
    EXPECT_NEAR(dense.porosity, 0.36,
                0.012);  // random close packing (0.36 for equal spheres, a little less here)
}

TEST(Packing, DependsOnTheSeedAndOnNothingElse) {
    const PackingResult a = make_packing(small(0.45, 3)), b = make_packing(small(0.45, 3)),
                        c = make_packing(small(0.45, 4));
    EXPECT_EQ(a.packing.centres, b.packing.centres);
    EXPECT_EQ(a.packing.cell, b.packing.cell);
    EXPECT_NE(a.packing.centres, c.packing.centres);
}

TEST(Packing, RadiiAreUniformInTheirRange) {
    const PackingResult made = make_packing(small(0.45));
    const Eigen::ArrayXd r = made.packing.radii.array();
    EXPECT_GE(r.minCoeff(), 0.055 * 0.7);
    EXPECT_LE(r.maxCoeff(), 0.055 * 1.3);
    EXPECT_NEAR(r.mean(), 0.055, 1e-4);
    EXPECT_NEAR(std::sqrt((r - r.mean()).square().mean()), 0.055 * 0.6 / std::sqrt(12.0), 2e-4);
}

TEST(Packing, OptionsAreChecked) {
    PackingOptions options = small(0.45);
    options.particles = 3;
    EXPECT_THROW(make_packing(options), std::invalid_argument);
    options = small(0.9);
    EXPECT_THROW(make_packing(options), std::invalid_argument);
    EXPECT_THROW(make_packing(small(0.45), [] { return true; }), std::runtime_error);  // cancelled
}

TEST(Servo, HoldsTheStressOfEveryAxisWithinOnePercent) {
    Simulation simulation(make_packing(small(0.44)).packing, LinearCohesive{}, {});
    ServoOptions options;
    const ServoSummary seated = consolidate(simulation, 5000, options);
    EXPECT_TRUE(seated.converged);
    StressServo servo(Eigen::Vector3d(5000, 5000, 8000), options);
    double error = 0;
    for (int k = 0; k < 4000; ++k) {
        const Measurement& now = servo.advance(simulation);
        if (k >= 2000)
            error += std::abs(now.stress(2, 2) - 8000) / 8000 + std::abs(now.stress(0, 0) - 5000) / 5000;
    }
    EXPECT_LT(error / 4000, 0.01);
}

TEST(Rates, FollowTheDefinitionOfTheInertialNumber) {
    // I = rate d sqrt(rho / p): 0.02 /s, 0.11 m, 2600 kg/m3, 15 kPa give 9.16e-4.
    EXPECT_NEAR(inertial_number(0.02, 15000, 0.11, 2600), 9.16e-4, 1e-6);
    EXPECT_NEAR(rate_for_inertial_number(9.16e-4, 15000, 0.11, 2600), 0.02, 2e-5);
}

}  // namespace
}  // namespace loam::engine
