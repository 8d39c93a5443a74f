// One sphere and walls, against closed forms. A wall is of the grains' material: with linear springs k = E R,
// as between equal spheres (De Pue et al. 2019, eq. 4, two stiffnesses 2 E R in series). Times and speeds of
// impact err by the square of w dt, w² = k / m, as in test_normal_impact.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "engine/simulation.hpp"
#include "tests/verification/two_spheres.hpp"

namespace loam::engine {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double modulus = 1e8, density = 2600, radius = 0.05, pi = std::numbers::pi;
constexpr double stiffness = modulus * radius;

Packing one_sphere(const Vector3d& centre) {
    Packing packing;  // a cell of 1 m
    packing.centres = centre;
    packing.radii = Eigen::VectorXd::Constant(1, radius);
    return packing;
}

SimulationOptions undamped(bool free_rotation = false, double safety = 0.01) {
    SimulationOptions options;
    options.damping = 0;
    options.time_step_safety = safety;
    options.free_rotation = free_rotation;
    options.energy_balance = true;
    return options;
}

double mass() {
    return sphere_mass(radius, density);
}

TEST(WallImpact, SpeedTimeAndImpulseAreThoseOfASpring) {
    // Half a period pi sqrt(m / k); the speed is reversed; the wall takes up 2 m v, exactly the change of
    // momentum whatever the time step. The wall is oblique and its velocity is added to both.
    const Vector3d n = Vector3d(2, -1, 2) / 3, middle(0.5, 0.5, 0.5), drift(0.2, 0.3, -0.1);
    for (const double safety : {0.04, 0.01}) {
        Simulation simulation(one_sphere(middle + (radius + 2e-5) * n), elastic_law(modulus),
                              undamped(false, safety));
        Wall wall = Wall::plane(middle, n, 0.3);
        wall.velocity = drift;
        simulation.add_wall(wall);
        const double speed = 1e-3 * radius * std::sqrt(stiffness / mass());
        simulation.set_velocities(Vector3d(drift - speed * n));
        Vector3d impulse = Vector3d::Zero();
        int touching = 0;
        for (bool met = false;;) {
            const bool touches = simulation.advance(1).wall_contacts > 0;
            impulse += simulation.time_step() * simulation.walls().force(0);
            touching += touches ? 1 : 0;
            met = met || touches;
            if (met && !touches) break;
        }
        const Vector3d change = simulation.velocities().col(0) - (drift - speed * n);
        const double h = std::sqrt(stiffness / mass()) * simulation.time_step();
        EXPECT_LT((impulse + mass() * change).norm(), 1e-12 * mass() * speed);
        EXPECT_LT((change - 2 * speed * n).norm() / speed, 0.5 * h * h);
        EXPECT_NEAR(touching * simulation.time_step(), pi * std::sqrt(mass() / stiffness),
                    2 * simulation.time_step());
        EXPECT_LT(simulation.energy().sliding, 1e-3 * 0.5 * mass() * speed * speed);
    }
}

TEST(WallImpact, LocalDampingGivesTheSameRestitutionAsBetweenSpheres) {
    // sqrt((1 - alpha) / (1 + alpha)), see test_normal_impact.cpp.
    SimulationOptions how = undamped();
    how.damping = 0.3;
    Simulation simulation(one_sphere({0.5, 0.5, radius + 0.1 + 1e-5}), elastic_law(modulus), how);
    simulation.add_wall(Wall::plane({0.5, 0.5, 0.1}, Vector3d::UnitZ(), 1));
    simulation.set_velocities(Vector3d(0, 0, -0.1));
    while (simulation.advance(1).wall_contacts == 0) {
    }
    while (simulation.advance(1).wall_contacts > 0) {
    }
    EXPECT_NEAR(simulation.velocities()(2, 0) / 0.1, std::sqrt((1 - 0.3) / (1 + 0.3)), 1e-4);
}

/// A sphere between two walls, pressed by a constant overlap with the lower one and, where wanted, held down
/// by a frictionless upper one, so that the normal load is constant; sliding along x at v0.
struct Slide {
    explicit Slide(double friction_angle, bool free_rotation, double overlap, double v0)
        : simulation(one_sphere({0.5, 0.5, 0.1 + radius - overlap}), elastic_law(modulus),
                     undamped(free_rotation, 0.1)) {
        Wall floor = Wall::plane({0.5, 0.5, 0.1}, Vector3d::UnitZ(), 10);
        floor.friction_angle = friction_angle;
        simulation.add_wall(floor);
        simulation.add_wall(Wall::plane({0.5, 0.5, 0.1 + 2 * (radius - overlap)}, Vector3d(0, 0, -1), 10));
        simulation.set_velocities(Vector3d(v0, 0, 0));
        load = stiffness * overlap;
    }
    double speed() const { return simulation.velocities()(0, 0); }
    Simulation simulation;
    double load;
};

TEST(WallFriction, ASlidingSphereIsSlowedByMuTimesItsLoad) {
    // Blocked rotation: v = v0 - mu N / m t. Tolerance: the shear spring loads first, over a way of mu N /
    // k_t.
    const double mu = 0.4, overlap = 1e-6, v0 = 0.2;
    Slide slide(std::atan(mu), false, overlap, v0);
    const double deceleration = mu * slide.load / mass();
    slide.simulation.advance(200);  // past the loading of the spring
    const double start = slide.speed(), dt = slide.simulation.time_step();
    const int steps = static_cast<int>(0.5 * start / deceleration / dt);
    ASSERT_GT(steps, 500);
    slide.simulation.advance(steps);
    EXPECT_NEAR((start - slide.speed()) / (steps * dt * deceleration), 1.0, 1e-9);
    EXPECT_NEAR(slide.simulation.walls().force(0).x(), mu * slide.load, 1e-9 * slide.load);
    EXPECT_NEAR(slide.simulation.walls().force(0).z(), -slide.load, 1e-9 * slide.load);
    EXPECT_NEAR(slide.simulation.walls().force(1).z(), slide.load, 1e-9 * slide.load);
    // What it lost of its energy went into sliding, but for what the spring holds.
    const double lost = 0.5 * mass() * (v0 * v0 - slide.speed() * slide.speed());
    EXPECT_NEAR(slide.simulation.energy().sliding / lost, 1.0, 2e-3);
    EXPECT_LT(slide.simulation.energy().error(), 2e-3);
}

TEST(WallFriction, AFreeSphereEndsRollingAtFiveSeventhsOfItsSpeed) {
    // m v' = -mu N, I w' = mu N R: v = R w at t = 2 v0 m / (7 mu N), where v = 5/7 v0 (Coriolis 1835). The
    // shear spring then holds some of the energy and swings; the mean speed is compared, tolerance 2 %.
    const double mu = 0.2, overlap = 1e-6, v0 = 0.1;
    Slide slide(std::atan(mu), true, overlap, v0);
    const double until = 2 * v0 * mass() / (7 * mu * slide.load), dt = slide.simulation.time_step();
    const int steps = static_cast<int>(until / dt);
    ASSERT_GT(steps, 200);
    slide.simulation.advance(static_cast<int>(0.9 * steps));
    EXPECT_NEAR(slide.simulation.walls().force(0).x(), mu * slide.load, 1e-6 * slide.load);
    EXPECT_NEAR(slide.speed() / v0, 1 - 0.9 * 2 / 7, 5e-3);
    slide.simulation.advance(static_cast<int>(0.2 * steps));
    double mean = 0;
    for (int k = 0; k < 4 * steps; ++k) {
        slide.simulation.advance(1);
        mean += slide.speed() / (4 * steps);
    }
    EXPECT_NEAR(mean / v0, 5.0 / 7, 0.02);
}

TEST(WallContact, ASphereRestsInACorner) {
    // Three walls and a mean field that drives the sphere into them; each takes the part of the load normal
    // to it.
    const Vector3d corner(0.2, 0.25, 0.3), load(3, 4, 12);  // N
    Simulation simulation(one_sphere(corner + Vector3d::Constant(radius) - load / stiffness),
                          elastic_law(modulus), undamped(false, 0.006));
    for (int k = 0; k < 3; ++k) simulation.add_wall(Wall::plane(corner, Vector3d::Unit(k), 0.2));
    // Walls on the other side hold it there: the overlaps are those of the load on either side.
    for (int k = 0; k < 3; ++k)
        simulation.add_wall(Wall::plane(corner + 2 * Vector3d::Constant(radius) - 2 * load / stiffness,
                                        -Vector3d::Unit(k), 0.2));
    simulation.advance(1000);
    EXPECT_LT(simulation.velocities().norm(), 1e-12);
    EXPECT_EQ(simulation.measured().wall_contacts, 6);
    for (int k = 0; k < 3; ++k) {
        const auto wall = static_cast<std::size_t>(k);
        EXPECT_LT((simulation.walls().force(wall) + load[k] * Vector3d::Unit(k)).norm(), 1e-9);
        EXPECT_LT((simulation.walls().force(wall + 3) - load[k] * Vector3d::Unit(k)).norm(), 1e-9);
    }
}

TEST(WallContact, AnEdgePushesFromItsNearestPoint) {
    Wall wall;  // a square in the plane z = 0.5, from x = 0.2 to x = 0.4
    wall.origin = {0.2, 0.4, 0.5};
    wall.edge_a = {0.2, 0, 0};
    wall.edge_b = {0, 0.2, 0};
    const auto force_at = [&](const Vector3d& centre) {
        Simulation simulation(one_sphere(centre), elastic_law(modulus), undamped());
        simulation.add_wall(wall);
        simulation.advance(1);
        return Vector3d(-simulation.walls().force(0));  // on the sphere
    };
    const double d = 0.9 * radius, push = stiffness * 0.1 * radius;
    const Vector3d oblique = Vector3d(3, 0, 4) / 5, diagonal = Vector3d(1, 1, -1).normalized();
    const Vector3d edge(0.4, 0.5, 0.5), corner(0.4, 0.6, 0.5);
    EXPECT_LT((force_at(edge + d * oblique) - push * oblique).norm(), 1e-9 * push);
    EXPECT_LT((force_at(edge + d * Vector3d::UnitX()) - push * Vector3d::UnitX()).norm(), 1e-9 * push);
    EXPECT_LT((force_at(corner + d * diagonal) - push * diagonal).norm(), 1e-9 * push);
    EXPECT_LT((force_at({0.3, 0.5, 0.5 - d}) + push * Vector3d::UnitZ()).norm(), 1e-9 * push);
    EXPECT_EQ(force_at(edge + 1.001 * radius * oblique).norm(), 0);
}

TEST(WallContact, ASphereDoesNotLeakBetweenRectanglesThatSlideApart) {
    // Two halves of a wall part under a sphere that is pressed on them, until the gap is 1.6 R wide: it sinks
    // in, held by both edges, to where their distance from its centre is R (less the overlap, 1e-3 R).
    const double gap_end = 1.6 * radius;
    Simulation simulation(one_sphere({0.5, 0.5, 0.5 + radius}), elastic_law(modulus), [] {
        SimulationOptions how;
        how.damping = 0.4;
        how.time_step_safety = 0.45;
        return how;
    }());
    Wall left;
    left.origin = {0.3, 0.3, 0.5};
    left.edge_a = {0.2, 0, 0};
    left.edge_b = {0, 0.4, 0};
    left.velocity = {-0.005, 0, 0};
    Wall right = left;
    right.origin = {0.5, 0.3, 0.5};
    right.velocity = -left.velocity;
    Wall lid = Wall::plane({0.5, 0.5, 0.5 + 2 * radius}, Vector3d(0, 0, -1), 0.3);
    simulation.add_wall(left);
    simulation.add_wall(right);
    simulation.add_wall(lid);
    simulation.set_wall_velocity(2, {0, 0, 0});
    double time = 0;
    while (0.01 * time < gap_end) {
        // The lid is lowered by a servo as plain as can be, to a load of 1e-3 R k.
        const double missing = 1e-3 * radius * stiffness - simulation.walls().force(2).z();
        simulation.set_wall_velocity(2, {0, 0, -0.5 * missing / stiffness / (20 * simulation.time_step())});
        simulation.advance(1);
        time += simulation.time_step();
    }
    simulation.set_wall_velocity(0, Vector3d::Zero());
    simulation.set_wall_velocity(1, Vector3d::Zero());
    simulation.set_wall_velocity(2, Vector3d::Zero());
    simulation.advance(2000);
    const double gap = simulation.walls().wall(1).origin.x() - simulation.walls().wall(0).origin.x() - 0.2;
    const Vector3d x = simulation.packing().centres.col(0);
    EXPECT_NEAR(gap, gap_end, 0.01 * radius);
    EXPECT_NEAR(x.x(), 0.5, 1e-3 * radius);
    EXPECT_NEAR(x.z() - 0.5, std::sqrt(radius * radius - gap * gap / 4), 5e-3 * radius);
    EXPECT_LT(
        (simulation.walls().force(0) + simulation.walls().force(1) + simulation.walls().force(2)).norm(),
        1e-3 * simulation.walls().force(2).norm());
}

TEST(WallContact, HistoryOutlivesTheRebuildOfTheLists) {
    // A sphere that sticks to a wall which moves along: far beyond the skin, the shear force stays what it
    // was.
    LinearCohesive law = elastic_law(modulus);
    Simulation simulation(one_sphere({0.2, 0.5, 0.1 + radius - 1e-5}), law, undamped(false, 0.1));
    Wall floor = Wall::plane({0.5, 0.5, 0.1}, Vector3d::UnitZ(), 10);
    floor.friction_angle = 1.0;
    Wall lid = Wall::plane({0.5, 0.5, 0.1 + 2 * (radius - 1e-5)}, Vector3d(0, 0, -1), 10);
    lid.friction_angle = 1.0;
    simulation.add_wall(floor);
    simulation.add_wall(lid);
    simulation.set_wall_velocity(0, Vector3d(1e-3, 0, 0));  // shears the sphere between the two
    simulation.set_wall_velocity(1, Vector3d(-1e-3, 0, 0));
    simulation.advance(50);
    const double shear = simulation.walls().force(0).x();
    ASSERT_LT(shear, -1e-3);
    simulation.set_wall_velocity(0, Vector3d(0.5, 0, 0));
    simulation.set_wall_velocity(1, Vector3d(0.5, 0, 0));
    simulation.set_velocities(Vector3d(0.5, 0, 0));
    const auto before = simulation.rebuilds();
    while (simulation.packing().centres(0, 0) < 0.7) simulation.advance(100);
    EXPECT_GT(simulation.rebuilds(), before + 10);
    EXPECT_NEAR(simulation.walls().force(0).x() / shear, 1.0,
                0.05);  // the last step before the change is new
}

}  // namespace
}  // namespace loam::engine
