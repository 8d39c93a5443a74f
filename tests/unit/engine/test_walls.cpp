// Walls and boxes as a caller meets them: checks of input, motion, bookkeeping, and ends with a reason.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "engine/boxed_packing.hpp"
#include "engine/loading.hpp"
#include "engine/wall_servo.hpp"

namespace loam::engine {
namespace {

using Eigen::Vector3d;

Simulation one_sphere(const Vector3d& centre = {0.5, 0.5, 0.5}) {
    Packing packing;  // a cell of 1 m
    packing.centres = centre;
    packing.radii = Eigen::VectorXd::Constant(1, 0.05);
    LinearCohesive law;
    law.young_modulus = 1e7;
    return Simulation(packing, law, {});
}

/// The message of the exception that an action ends with.
std::string reason(const std::function<void()>& action) {
    try {
        action();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "none";
}

testing::AssertionResult says(const std::string& message, const std::string& part) {
    if (message.find(part) != std::string::npos) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "\"" << message << "\" does not say \"" << part << "\"";
}

BoxedPackingOptions small(double porosity = 0.44, std::uint64_t seed = 1) {
    BoxedPackingOptions options;
    options.particles = 200;
    options.target_porosity = porosity;
    options.seed = seed;
    return options;
}

TEST(Wall, NearestPointIsOnTheFaceAnEdgeOrACorner) {
    Wall wall;  // 2 x 1 in the plane z = 3
    wall.origin = {1, 1, 3};
    wall.edge_a = {2, 0, 0};
    wall.edge_b = {0, 1, 0};
    EXPECT_EQ(wall.nearest({1.5, 1.5, 7}), Vector3d(1.5, 1.5, 3));
    EXPECT_EQ(wall.nearest({5, 1.25, -1}), Vector3d(3, 1.25, 3));
    EXPECT_EQ(wall.nearest({0, 9, 3}), Vector3d(1, 2, 3));
    EXPECT_EQ(wall.normal(), Vector3d(0, 0, 1));
    EXPECT_EQ(wall.centre(), Vector3d(2, 1.5, 3));
    EXPECT_EQ(wall.area(), 2);
    const Vector3d n = Vector3d(1, -2, 2) / 3, point(0.1, 0.2, 0.3);
    const Wall plane = Wall::plane(point, n, 4);
    EXPECT_LT((plane.normal() - n).norm(), 1e-15);
    EXPECT_LT((plane.centre() - point).norm(), 1e-14);
    EXPECT_NEAR(plane.area(), 64, 1e-12);
}

TEST(Wall, UnsoundInputIsRefusedByName) {
    Simulation simulation = one_sphere();
    const auto refusal = [&](const std::function<void(Wall&)>& spoil) {
        Wall wall;
        spoil(wall);
        return reason([&] { simulation.add_wall(wall); });
    };
    EXPECT_TRUE(says(refusal([](Wall& w) { w.edge_b = {0.1, 1, 0}; }), "rectangle"));
    EXPECT_TRUE(says(refusal([](Wall& w) { w.edge_a.setZero(); }), "edge_a"));
    EXPECT_TRUE(says(refusal([](Wall& w) { w.origin.x() = NAN; }), "finite"));
    EXPECT_TRUE(says(refusal([](Wall& w) { w.friction_angle = 1.6; }), "friction_angle"));
    EXPECT_TRUE(says(reason([] { Wall::plane({0, 0, 0}, {0, 0, 0}, 1); }), "normal"));
    EXPECT_EQ(simulation.walls().size(), 0u);
    EXPECT_TRUE(says(reason([&] { simulation.set_wall_velocity(0, {0, 0, 0}); }), "wall 0"));
    ASSERT_EQ(simulation.add_wall(Wall{}), 0u);
    EXPECT_TRUE(says(reason([&] { simulation.set_wall_velocity(0, {0, NAN, 0}); }), "velocity"));
    EXPECT_TRUE(says(reason([&] { simulation.drive_wall(1, {}); }), "wall 1"));
    EXPECT_TRUE(says(reason([&] { simulation.set_reference_volume(0); }), "reference volume"));
    EXPECT_TRUE(says(reason([] { WallServo(0, -1, 1); }), "pressure"));
    EXPECT_TRUE(says(reason([&] { add_box(simulation, Box{{0, 0, 0}, {1, -1, 1}}); }), "side"));
}

TEST(Wall, UnsoundBoxedPackingsAreRefusedByName) {
    BoxedPackingOptions options = small();
    options.proportions = {1, 0, 1};
    EXPECT_TRUE(says(reason([&] { make_boxed_packing(options); }), "proportions"));
    options = small();
    options.particles = 5;
    EXPECT_TRUE(says(reason([&] { make_boxed_packing(options); }), "particles"));
    options = small();
    options.margin = 0;
    EXPECT_TRUE(says(reason([&] { make_boxed_packing(options); }), "margin"));
}

TEST(Walls, MoveByTheirVelocityAndWithTheField) {
    Simulation simulation = one_sphere();
    Wall wall = Wall::plane({0.5, 0.5, 0.2}, Vector3d::UnitZ(), 5);
    wall.velocity = {0, 0.5, 0.25};
    simulation.add_wall(wall);
    simulation.advance(100);
    const double time = 100 * simulation.time_step();
    const Vector3d expected(0.5, 0.5 + 0.5 * time, 0.2 + 0.25 * time);
    EXPECT_LT((simulation.walls().wall(0).centre() - expected).norm(), 1e-13);
    simulation.set_wall_velocity(0, Vector3d::Zero());
    const double height = simulation.walls().wall(0).centre().z(), rate = 1e-4 / simulation.time_step();
    simulation.set_velocity_gradient(Vector3d(0, 0, -rate).asDiagonal());
    simulation.advance(100);
    EXPECT_NEAR(simulation.walls().wall(0).centre().z(), height * std::pow(1 - 1e-4, 100), 1e-13);
    EXPECT_NEAR(simulation.walls().wall(0).area(), 100, 1e-12);  // rigid
}

TEST(Walls, WhatTouchesNothingChangesNoBit) {
    const BoxedPackingResult made = make_boxed_packing(small());
    Eigen::Matrix3Xd centres[2];
    for (const bool walled : {false, true}) {
        Simulation simulation(made.packing, LinearCohesive{}, {});
        if (walled) simulation.add_wall(Wall::plane({0, 0, 1e-3}, Vector3d::UnitZ(), 10));
        simulation.advance(300);
        centres[walled ? 1 : 0] = simulation.packing().centres;
    }
    EXPECT_EQ(centres[0], centres[1]);
}

TEST(Walls, ARunEndsWithAReasonWhenAParticleLeaves) {
    const auto end_of = [](const Vector3d& velocity, bool walled) {
        Simulation simulation = one_sphere();
        if (walled) simulation.add_wall(Wall::plane({0.5, 0.5, 0.4}, Vector3d::UnitZ(), 0.2));
        simulation.set_velocities(velocity);
        return reason([&] {
            for (int k = 0; k < 100; ++k) simulation.advance(20);
        });
    };
    EXPECT_TRUE(says(end_of({1, 0, 0}, true), "face of the cell"));
    EXPECT_EQ(end_of({1, 0, 0}, false), "none");
    // It comes R/2 deep with the energy of k (R/2)² / 2, at sqrt((1 + damping) k / m) R / 2 = 25 m/s.
    EXPECT_FALSE(says(end_of({0, 0, -15}, true), "pressed"));
    EXPECT_TRUE(says(end_of({0, 0, -30}, true), "half of"));
    EXPECT_NE(end_of({0, 0, -1e200}, true), "none");
}

TEST(Walls, AParticleBehindAOneSidedWallEndsTheRun) {
    Simulation simulation = one_sphere({0.5, 0.5, 0.3});
    Wall wall = Wall::plane({0.5, 0.5, 0.4}, Vector3d::UnitZ(), 0.2);
    simulation.add_wall(wall);
    EXPECT_NO_THROW(simulation.advance(1));
    wall.one_sided = true;
    simulation.add_wall(wall);
    EXPECT_TRUE(says(reason([&] { simulation.advance(1); }), "behind wall 1"));
}

TEST(Box, TheReferenceVolumeFollowsTheField) {
    const BoxedPackingResult made = make_boxed_packing(small());
    Simulation simulation(made.packing, LinearCohesive{}, {});
    const BoxWalls walls = add_box(simulation, made.box, 0.2);
    EXPECT_EQ(present_box(simulation, walls).low, made.box.low);
    EXPECT_NEAR(simulation.porosity(), made.porosity, 1e-12);
    simulation.set_velocity_gradient(Vector3d(0.02, 0, -0.05).asDiagonal());
    simulation.advance(500);
    const Box now = present_box(simulation, walls);
    EXPECT_NEAR(simulation.volume() / now.volume(), 1, 1e-12);
    EXPECT_NE(now.volume(), made.box.volume());
    EXPECT_NEAR(now.area(2), now.sides().x() * now.sides().y(), 1e-12);
}

TEST(BoxedPacking, MeetsThePorosityInsideTheBox) {
    BoxedPackingOptions options = small(0.45);
    options.proportions = {1, 1, 0.7};
    const BoxedPackingResult made = make_boxed_packing(options);
    EXPECT_TRUE(made.reached) << made.stopped_by;
    const double solid = 4.0 / 3 * 3.14159265358979 * made.packing.radii.array().pow(3).sum();
    EXPECT_NEAR(1 - solid / made.box.volume(), 0.45, options.tolerance);
    EXPECT_NEAR(made.box.sides().z() / made.box.sides().x(), 0.7, 0.05);
    for (Eigen::Index p = 0; p < made.packing.radii.size(); ++p) {
        EXPECT_GT((made.packing.centres.col(p) - made.box.low).minCoeff(), 0.97 * made.packing.radii[p]);
        EXPECT_GT((made.box.high - made.packing.centres.col(p)).minCoeff(), 0.97 * made.packing.radii[p]);
    }
    for (int k = 0; k < 3; ++k) {  // room to move
        EXPECT_GT(made.box.low[k], 0.05);
        EXPECT_LT(made.box.high[k], made.packing.cell(k, k) - 0.05);
    }
}

TEST(BoxedPacking, DependsOnTheSeedAlone) {
    const BoxedPackingResult a = make_boxed_packing(small()), b = make_boxed_packing(small()),
                             c = make_boxed_packing(small(0.44, 2));
    EXPECT_EQ(a.packing.centres, b.packing.centres);
    EXPECT_EQ(a.box.high, b.box.high);
    EXPECT_NE(a.packing.centres, c.packing.centres);
}

TEST(BoxedPacking, TheSameRunGivesTheSameBits) {
    const BoxedPackingResult made = make_boxed_packing(small());
    Vector3d force[2];
    for (Vector3d& f : force) {
        SimulationOptions how;
        how.free_rotation = true;
        Simulation simulation(made.packing, LinearCohesive{}, how);
        const BoxWalls walls = add_box(simulation, made.box, 0.3);
        simulation.advance(1);
        const WallServo servo(walls[5], 5000, made.box.area(2));
        for (int k = 0; k < 600; ++k) {  // stiffer than the packing was made with, it settles anew
            servo.steer(simulation);
            simulation.advance(10);
        }
        f = simulation.walls().force(walls[5]);
        EXPECT_NEAR(servo.pressure(simulation), 5000, 250);
    }
    EXPECT_EQ(force[0], force[1]);
}

}  // namespace
}  // namespace loam::engine
