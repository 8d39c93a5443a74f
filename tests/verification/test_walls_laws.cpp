// One sphere and a wall under each law that test_walls.cpp leaves out, against the closed forms of
// test_further_laws.cpp. The wall is of the grains' material, but does not move:
//   linear-damped: k = pi/2 E R, as between equal spheres, one of them of infinite mass;
//   hertz-mindlin: R* = R (Hertz 1882), Y as between two spheres.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/simulation.hpp"
#include "tests/verification/two_spheres.hpp"

namespace loam::engine {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double radius = 0.05, density = 2600;

Packing one_sphere(const Vector3d& centre) {
    Packing packing;  // a cell of 1 m
    packing.centres = centre;
    packing.radii = Eigen::VectorXd::Constant(1, radius);
    return packing;
}

struct Impact {
    double duration = 0, peak_force = 0, restitution = 0;
};

Impact fall(const ContactLaw& law, double speed) {
    SimulationOptions how;
    how.damping = 0;
    how.time_step_safety = 0.002;
    Simulation simulation(one_sphere({0.5, 0.5, 0.1 + radius + 1e-9}), law, how);
    simulation.add_wall(Wall::plane({0.5, 0.5, 0.1}, Vector3d::UnitZ(), 1));
    simulation.set_velocities(Vector3d(0, 0, -speed));
    Impact impact;
    while (impact.peak_force == 0 || simulation.measured().wall_contacts > 0) {
        const double step = simulation.time_step();  // may change after the step, with the overlap
        simulation.advance(1);
        impact.peak_force = std::max(impact.peak_force, simulation.walls().force(0).norm());
        if (simulation.measured().wall_contacts > 0) impact.duration += step;
    }
    impact.restitution = simulation.velocities()(2, 0) / speed;
    return impact;
}

TEST(WallLaws, LinearDampedHasTheRestitutionOfADampedOscillator) {
    // exp(-pi D / sqrt(1 - D²)) and pi / (w sqrt(1 - D²)), w² = k / m; tolerances as in
    // test_further_laws.cpp.
    for (const double share : {0.0, 0.05, 0.2}) {
        LinearDamped law;
        law.young_modulus = 1e8;
        law.normal_damping = share;
        const double w = std::sqrt(pi / 2 * law.young_modulus * radius / sphere_mass(radius, density));
        const double slow = std::sqrt(1 - share * share);
        const Impact impact = fall(law, 0.3);
        EXPECT_NEAR(impact.restitution / std::exp(-pi * share / slow), 1, 5e-3) << share;
        EXPECT_NEAR(impact.duration * w * slow / pi, 1, 3e-3) << share;
    }
}

TEST(WallLaws, HertzianImpactOnAPlane) {
    // Largest overlap (15 m v² / (16 Y sqrt R))^(2/5), peak force 4/3 Y sqrt(R) overlap^(3/2), duration
    // 2.9432 overlap / v.
    HertzMindlin law;
    law.young_modulus = 5e8;
    law.restitution = 1;
    const double y = law.young_modulus / (2 * (1 - law.poisson_ratio * law.poisson_ratio));
    const double v = 0.3, m = sphere_mass(radius, density);
    const double overlap = std::pow(15 * m * v * v / (16 * y * std::sqrt(radius)), 0.4);
    const Impact impact = fall(law, v);
    EXPECT_NEAR(impact.peak_force / (4.0 / 3 * y * std::sqrt(radius) * std::pow(overlap, 1.5)), 1, 2e-3);
    EXPECT_NEAR(impact.duration * v / overlap, 2.9432, 0.01);
    EXPECT_NEAR(impact.restitution, 1, 1e-3);
    law.restitution = 0.6;  // at any speed
    EXPECT_NEAR(fall(law, 0.3).restitution, 0.6, 0.01);
    EXPECT_NEAR(fall(law, 0.03).restitution, 0.6, 0.01);
}

TEST(WallLaws, RollingResistanceStopsARollingSphere) {
    // m v' = -f, I w' = f R - M and v = R w: v' = -5/7 M / (m R). Two walls press with the load N each, and
    // each resists rolling with up to mu_r N R; the upper one has no friction.
    ContactLaw law(elastic_law(1e8));
    law.rolling.friction = 0.02;
    law.rolling.stiffness = 2;
    SimulationOptions how;
    how.damping = 0;
    how.free_rotation = true;
    how.time_step_safety = 0.05;
    const double overlap = 1e-6, load = 1e8 * radius * overlap, v0 = 0.05;
    Simulation simulation(one_sphere({0.3, 0.5, 0.1 + radius - overlap}), law, how);
    Wall floor = Wall::plane({0.5, 0.5, 0.1}, Vector3d::UnitZ(), 10);
    floor.friction_angle = 0.5;
    simulation.add_wall(floor);
    simulation.add_wall(Wall::plane({0.5, 0.5, 0.1 + 2 * (radius - overlap)}, -Vector3d::UnitZ(), 10));
    simulation.set_velocities(Vector3d(v0, 0, 0));
    simulation.set_spins(Vector3d(0, v0 / radius, 0));
    const double deceleration = 2 * 5.0 / 7 * law.rolling.friction * load / sphere_mass(radius, density);
    const double dt = simulation.time_step();
    const int steps = static_cast<int>(0.5 * v0 / deceleration / dt);
    ASSERT_GT(steps, 1000);
    simulation.advance(steps);
    EXPECT_NEAR(simulation.velocities()(0, 0) / (v0 - deceleration * steps * dt), 1, 0.01);
    EXPECT_NEAR(simulation.spins()(1, 0) * radius / simulation.velocities()(0, 0), 1, 0.01);
    simulation.advance(2 * steps);  // past its stop it rests, but for the swing of the springs
    EXPECT_LT(std::abs(simulation.velocities()(0, 0)), 0.05 * v0);
}

}  // namespace
}  // namespace loam::engine
