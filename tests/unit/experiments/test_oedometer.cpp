// The virtual oedometer: stages are held until the packing is at rest, and what ends a run is said.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/packing.hpp"
#include "experiments/lab_tests/oedometer.hpp"

namespace loam::experiments {
namespace {

engine::Packing packing(std::uint64_t seed) {
    engine::PackingOptions options;
    options.particles = 300;
    options.seed = seed;
    return engine::make_packing(options).packing;
}

TEST(Oedometer, AStageIsReadAtItsStressAndAtRest) {
    engine::Simulation simulation(packing(1), {}, {});
    OedometerOptions options;
    options.stages = {50e3};
    const OedometerResult run = run_oedometer(simulation, {}, options);
    ASSERT_TRUE(run.complete) << run.reason;
    const engine::Measurement& now = simulation.measured();
    EXPECT_NEAR(now.stress(2, 2), 50e3, 50e3 * options.hold.stress_tolerance);
    EXPECT_LT(now.unbalanced_ratio, options.hold.unbalanced_ratio);
    EXPECT_NEAR(run.strain[0], 1 - simulation.cell()(2, 2) / run.initial_height, 1e-12);
    // Zero lateral strain since seating.
    EXPECT_NEAR(simulation.cell()(0, 0) / simulation.cell()(1, 1),
                packing(1).cell(0, 0) / packing(1).cell(1, 1), 0.02);
    // Held on, nothing moves: the reading was not a moment on the way.
    engine::hold_stress(simulation, {NAN, NAN, 50e3}, options.hold);
    EXPECT_NEAR(run.strain[0], 1 - simulation.cell()(2, 2) / run.initial_height, 2e-4);
}

TEST(Oedometer, HalvingTheRateMovesTheMeanCurveLittle) {
    OedometerOptions options;
    options.stages = {15e3, 57e3, 224e3, 895e3, 224e3};
    OedometerOptions slow = options;
    for (double* rate :
         {&slow.inertial_number, &slow.stress_change, &slow.strain_per_step, &slow.highest_inertial_number,
          &slow.least_strain_per_step, &slow.hold.inertial_number})
        *rate *= 0.5;
    engine::LinearCohesive
        rough;  // whose force chains seldom buckle: slippery packings scatter too much here
    rough.friction_angle = 0.6;
    Eigen::VectorXd change = Eigen::VectorXd::Zero(5);
    constexpr int packings = 18;  // one moves by 6e-4 or so
    for (std::uint64_t seed = 1; seed <= packings; ++seed) {
        const engine::Packing specimen = packing(seed);
        engine::Simulation one(specimen, rough, {}), two(specimen, rough, {});
        change +=
            (run_oedometer(two, rough, slow).strain - run_oedometer(one, rough, options).strain) / packings;
    }
    EXPECT_LT(change.cwiseAbs().maxCoeff(), 5e-4) << change.transpose();
}

TEST(Oedometer, SaysWhyAStageIsNotReached) {
    engine::LinearCohesive soft;
    soft.young_modulus = 1e6;
    OedometerOptions options;
    options.stages = {10e3, 500e3};
    options.largest_strain = 0.2;
    engine::Simulation crushed(packing(2), soft, {});
    const OedometerResult run = run_oedometer(crushed, soft, options);
    EXPECT_FALSE(run.complete);
    EXPECT_TRUE(std::isfinite(run.strain[0]));
    EXPECT_TRUE(std::isnan(run.strain[1]));
    EXPECT_EQ(run.reason, "axial strain passed 0.2 before 500 kPa");

    OedometerOptions impatient;
    impatient.stages = {50e3};
    impatient.hold.max_steps = 50;
    impatient.hold.unbalanced_ratio = 1e-9;
    engine::Simulation restless(packing(2), {}, {});
    EXPECT_EQ(run_oedometer(restless, {}, impatient).reason, "no rest at 50 kPa");
}

TEST(StressServo, AnAxisWithoutTargetKeepsItsLength) {
    engine::Simulation simulation(packing(3), {}, {});
    const double width = simulation.cell()(0, 0), height = simulation.cell()(2, 2);
    const engine::ServoSummary held = engine::hold_stress(simulation, {NAN, NAN, 500e3}, {});
    EXPECT_TRUE(held.converged);
    EXPECT_LT(held.stress_error, 0.01);
    EXPECT_EQ(simulation.cell()(0, 0), width);
    EXPECT_LT(simulation.cell()(2, 2), height);
    EXPECT_THROW(engine::StressServo({NAN, NAN, NAN}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace loam::experiments
