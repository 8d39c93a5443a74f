// The virtual triaxial test and the servo beneath it: what is held is held, what is read is what the cell
// does, and the answer scales as it must.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/packing.hpp"
#include "experiments/lab_tests/triaxial.hpp"

namespace loam::experiments {
namespace {

engine::Packing packing(std::uint64_t seed, double porosity, std::uint32_t particles = 300) {
    engine::PackingOptions options;
    options.particles = particles;
    options.target_porosity = porosity;
    options.seed = seed;
    return engine::make_packing(options).packing;
}

engine::LinearCohesive sand(double young_modulus, double friction_angle) {
    engine::LinearCohesive law;
    law.young_modulus = young_modulus;
    law.stiffness_ratio = 0.8;
    law.friction_angle = friction_angle;
    law.normal_cohesion = law.shear_cohesion = 0;
    return law;
}

TriaxialOptions to(std::vector<double> strains) {
    TriaxialOptions options;
    options.strains = std::move(strains);
    return options;
}

TEST(Triaxial, HoldsTheLateralStressAndReadsWhatTheCellDoes) {
    for (const bool free_rotation : {false, true}) {
        engine::SimulationOptions how;
        how.free_rotation = free_rotation;
        how.energy_balance = true;
        engine::Simulation simulation(packing(1, 0.41), sand(1e8, 0.4), how);
        const TriaxialResult run = run_triaxial(simulation, sand(1e8, 0.4), to({0, 0.01, 0.05, 0.1}));
        ASSERT_TRUE(run.complete) << run.reason;
        ASSERT_EQ(run.readings.size(), 4u);
        EXPECT_LT(run.mean_lateral_error, 0.01);
        EXPECT_LT(run.largest_lateral_error, 0.05);
        EXPECT_LT(run.energy_error, 0.01);
        EXPECT_LT(run.mean_unbalanced_ratio, 0.05);
        EXPECT_LE(run.largest_inertial_number, 1.001 * TriaxialOptions{}.highest_inertial_number);
        EXPECT_NEAR(run.readings[0].deviatoric_stress, 0, 3e3);
        const double solid = simulation.solid_volume();
        for (const TriaxialReading& reading : run.readings) {
            // Void ratio and volumetric strain are the same thing said twice.
            const double volume = solid / (1 - run.consolidated_porosity) * (1 - reading.volumetric_strain);
            EXPECT_NEAR(reading.void_ratio, volume / solid - 1, 1e-12);
            EXPECT_GT(reading.coordination_number, 2);
        }
        // The last reading is where the simulation stands, but for the stretch that passed it.
        EXPECT_NEAR(run.readings[3].void_ratio, simulation.volume() / solid - 1, 1e-4);
        EXPECT_DOUBLE_EQ(run.readings[3].axial_strain, 0.1);
        EXPECT_NEAR(simulation.measured().stress(0, 0), 1e5, 3e3);
    }
}

TEST(Triaxial, DenseDilatesAndLooseContracts) {
    const auto volumetric_strain = [](double porosity) {
        engine::Simulation simulation(packing(2, porosity), sand(1e8, 0.4), {});
        return run_triaxial(simulation, sand(1e8, 0.4), to({0.15})).readings.at(0).volumetric_strain;
    };
    EXPECT_LT(volumetric_strain(0.38), -0.01);
    EXPECT_GT(volumetric_strain(0.46), 0.01);
}

TEST(Triaxial, TheLinearLawKnowsOnlyPressureOverStiffness) {
    const engine::Packing specimen = packing(3, 0.41);
    const auto run = [&](double scale) {
        TriaxialOptions options = to({0.002, 0.01, 0.03});
        options.cell_pressure = 1e5 * scale;
        engine::Simulation simulation(specimen, sand(1e8 * scale, 0.4), {});
        return run_triaxial(simulation, sand(1e8 * scale, 0.4), options);
    };
    // Four: all numbers scale by powers of two, so that even rounding is the same.
    const TriaxialResult one = run(1), four = run(4);
    ASSERT_TRUE(one.complete && four.complete);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(four.readings[k].deviatoric_stress / 4, one.readings[k].deviatoric_stress, 1e-6);
        EXPECT_NEAR(four.readings[k].volumetric_strain, one.readings[k].volumetric_strain, 1e-12);
    }
}

// Later on curves of single packings part, since which chain of grains buckles next is chance.
TEST(Triaxial, HalvingTheRateMovesTheStartOfTheCurveLittle) {
    const engine::Packing specimen = packing(6, 0.41);
    const auto run = [&](double factor) {
        TriaxialOptions options = to({0.002, 0.005});
        for (double* rate : {&options.inertial_number, &options.stress_change, &options.strain_per_step,
                             &options.highest_inertial_number, &options.least_strain_per_step})
            *rate *= factor;
        engine::Simulation simulation(specimen, sand(1e8, 0.4), {});
        return run_triaxial(simulation, sand(1e8, 0.4), options);
    };
    const TriaxialResult one = run(1), slow = run(0.5);
    EXPECT_GT(2 * slow.steps, 3 * one.steps);
    for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_NEAR(one.readings[k].deviatoric_stress / slow.readings[k].deviatoric_stress, 1, 0.01);
        EXPECT_NEAR(one.readings[k].volumetric_strain, slow.readings[k].volumetric_strain, 5e-5);
    }
}

TEST(Triaxial, OptionsThatMakeNoSenseAreRefused) {
    engine::Simulation simulation(packing(4, 0.41), sand(1e8, 0.4), {});
    const auto refused = [&](const TriaxialOptions& options) {
        EXPECT_THROW(run_triaxial(simulation, sand(1e8, 0.4), options), std::invalid_argument);
    };
    refused(to({}));
    refused(to({0.02, 0.01}));
    refused(to({-0.01}));
    refused(to({0.9}));
    TriaxialOptions no_pressure = to({0.1});
    no_pressure.cell_pressure = 0;
    refused(no_pressure);
}

// One mechanism for all that is driven: simple shear under constant normal stress.
TEST(StressServo, ShearsUnderConstantNormalStress) {
    engine::SimulationOptions how;
    how.free_rotation = true;
    engine::Simulation simulation(packing(5, 0.41), sand(1e8, 0.4), how);
    consolidate(simulation, 1e5, {});
    const Eigen::Matrix3d before = simulation.cell();
    engine::StressServo servo({NAN, NAN, 1e5}, {.inertial_number = 2e-2});
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    gradient(0, 2) = 0.05;
    gradient(2, 2) = 123;  // of a controlled axis: ignored
    servo.prescribe(gradient);
    double error = 0, stretches = 0, time = 0, shear_stress = 0;
    while (time * 0.05 < 0.1) {
        const engine::Measurement& now = servo.advance(simulation);
        error += std::abs(now.stress(2, 2) / 1e5 - 1);
        shear_stress = -now.stress(0, 2);
        stretches += 1;
        time += 5 * simulation.time_step();
    }
    EXPECT_LT(error / stretches, 0.01);
    const Eigen::Matrix3d after = simulation.cell();
    EXPECT_EQ(after(0, 0), before(0, 0));
    EXPECT_EQ(after(1, 1), before(1, 1));
    EXPECT_NEAR(after(0, 2) / after(2, 2), 0.1, 0.005);
    EXPECT_GT(shear_stress, 2e4);
    EXPECT_LT(shear_stress, 8e4);
}

}  // namespace
}  // namespace loam::experiments
