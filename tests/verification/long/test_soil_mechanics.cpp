// What soil mechanics knows of triaxial tests, on packings of this engine.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "engine/packing.hpp"
#include "experiments/lab_tests/triaxial.hpp"

namespace loam {
namespace {

using experiments::TriaxialOptions;

constexpr double pressure = 1e5;  // Pa

engine::LinearCohesive sand() {
    engine::LinearCohesive law;
    law.young_modulus = 1e8;
    law.stiffness_ratio = 0.8;
    law.friction_angle = 0.4;
    law.normal_cohesion = law.shear_cohesion = 0;
    return law;
}

engine::SimulationOptions free_rotation() {
    engine::SimulationOptions how;
    how.free_rotation = true;
    how.density_scaling = true;
    return how;
}

struct Strength {
    double ratio = 0;       // mean deviatoric stress over cell pressure between two strains
    double void_ratio = 0;  // mean there
};

/// Means over the readings at these axial strains.
Strength triaxial(std::uint32_t particles, double porosity, std::uint64_t seed,
                  const std::vector<double>& strains) {
    engine::PackingOptions options;
    options.particles = particles;
    options.target_porosity = porosity;
    options.seed = seed;
    engine::Simulation simulation(engine::make_packing(options).packing, sand(), free_rotation());
    TriaxialOptions how;
    how.cell_pressure = pressure;
    how.strains = strains;
    how.seating_stiffness = 2e4;
    const auto run = run_triaxial(simulation, sand(), how);
    Strength out;
    for (const auto& reading : run.readings) {
        out.ratio += reading.deviatoric_stress / pressure / static_cast<double>(strains.size());
        out.void_ratio += reading.void_ratio / static_cast<double>(strains.size());
    }
    return out;
}

std::vector<double> every(double first, double last, double step) {
    std::vector<double> out;
    for (double x = first; x < last + 0.5 * step; x += step) out.push_back(x);
    return out;
}

/// Schofield and Wroth 1968: strength at large strain does not depend on how dense a specimen was made, nor
/// does, in the end, its void ratio.
TEST(SoilMechanics, DenseAndLooseEndAtTheSameCriticalState) {
    const std::vector<double> late = every(0.36, 0.5, 0.01);
    Strength dense, loose;
    for (const std::uint64_t seed : {1, 2, 3}) {
        const Strength d = triaxial(1500, 0.38, seed, late), l = triaxial(1500, 0.44, seed, late);
        dense.ratio += d.ratio / 3;
        loose.ratio += l.ratio / 3;
        dense.void_ratio += d.void_ratio / 3;
        loose.void_ratio += l.void_ratio / 3;
    }
    std::printf("q/p: dense %.3f, loose %.3f; void ratio: dense %.3f, loose %.3f (made at %.3f and %.3f)\n",
                dense.ratio, loose.ratio, dense.void_ratio, loose.void_ratio, 0.38 / 0.62, 0.44 / 0.56);
    EXPECT_NEAR(dense.ratio / loose.ratio, 1, 0.1);
    // They began 0.17 apart.
    EXPECT_LT(std::abs(dense.void_ratio - loose.void_ratio), 0.05);
}

/// Above some hundred particles the number of them only sets the scatter.
TEST(SoilMechanics, StrengthDoesNotDependOnTheNumberOfParticles) {
    const std::vector<double> strains = every(0.02, 0.2, 0.01);
    for (const std::uint32_t particles : {350u, 700u, 1400u, 2800u}) {
        const int packings = particles < 1000 ? 12 : 6;
        double mean = 0, squares = 0;
        for (int seed = 1; seed <= packings; ++seed) {
            const double q = triaxial(particles, 0.42, static_cast<std::uint64_t>(seed), strains).ratio;
            mean += q / packings;
            squares += q * q / packings;
        }
        const double sd = std::sqrt(std::max(0.0, squares - mean * mean) * packings / (packings - 1));
        std::printf("%u particles: q/p %.4f, scatter of one packing %.4f\n", particles, mean, sd);
        static double of_the_first = 0;
        if (of_the_first == 0) of_the_first = mean;
        EXPECT_NEAR(mean / of_the_first, 1, 0.05);
    }
}

}  // namespace
}  // namespace loam
