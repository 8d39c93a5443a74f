// What soil mechanics knows of triaxial tests, on packings of this engine.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "engine/boxed_packing.hpp"
#include "engine/packing.hpp"
#include "experiments/lab_tests/direct_shear.hpp"
#include "experiments/lab_tests/triaxial.hpp"

namespace loam {
namespace {

using experiments::DirectShearOptions;
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

/// Mean of shear over normal stress on the plane of shear, at these displacements, in a box of 44 mean
/// diameters' length, 11 of width and 13 of height, so that a shear zone of some ten fits in. Its walls are
/// smooth.
double direct_shear(std::uint64_t seed, const std::vector<double>& displacements) {
    engine::BoxedPackingOptions options;
    options.particles = 6000;
    options.proportions = {2, 0.5, 0.6};
    options.target_porosity = 0.42;
    options.seed = seed;
    const auto made = engine::make_boxed_packing(options);
    DirectShearOptions how;
    how.normal_stress = pressure;
    how.displacements = displacements;
    how.seating_stiffness = 2e4;
    const auto run = run_direct_shear(made.packing, made.box, sand(), free_rotation(), how);
    double out = 0;
    for (const auto& reading : run.readings)
        out += reading.shear_stress / reading.normal_stress / (1 - reading.wall_share) /
               static_cast<double>(displacements.size());
    return out;
}

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

/// Friction angle in plane strain by Matsuoka and Nakai 1974, where the intermediate stress is the geometric
/// mean of the others: I1 I2 / I3 = 9 + 8 tan²(triaxial friction angle).
double in_plane_strain(double triaxial_angle) {
    const double sum = std::sqrt(9 + 8 * std::pow(std::tan(triaxial_angle), 2)) - 1;  // s + 1/s
    const double ratio = std::pow(0.5 * (sum + std::sqrt(sum * sum - 4)), 2);         // s²: of the stresses
    return std::asin((ratio - 1) / (ratio + 1));
}

/// Davis 1968: where the plane of shear does not stretch and no longer dilates, stress and strain rate being
/// coaxial, the ratio of the stresses on it is the sine of the friction angle in plane strain. That is at
/// least the triaxial one (Mohr and Coulomb), and at most, as spheres have it, Matsuoka and Nakai's. In small
/// boxes the edges add to it: half as much again in one 14 diameters long.
TEST(SoilMechanics, DirectShearFollowsFromTheTriaxialFrictionAngle) {
    double q = 0, plane = 0;
    for (const std::uint64_t seed : {1, 2, 3}) {
        q += triaxial(1500, 0.42, seed, every(0.2, 0.4, 0.01)).ratio / 3;
        plane += direct_shear(seed, every(0.08, 0.16, 0.005)) / 3;
    }
    const double angle = std::asin(q / (2 + q));
    std::printf("triaxial friction angle %.3f rad; shear over normal stress %.3f, expected %.3f to %.3f\n",
                angle, plane, std::sin(angle), std::sin(in_plane_strain(angle)));
    EXPECT_GT(plane, 0.95 * std::sin(angle));
    EXPECT_LT(plane, 1.05 * std::sin(in_plane_strain(angle)));
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
