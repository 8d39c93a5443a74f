// A cluster of spheres that runs together and flies apart in the middle of an empty cell, under every law and
// way of turning, without local damping: momentum and angular momentum, spins among it, stay to rounding
// whatever the forces, since forces are opposite and the moments of a contact balance the couple of its shear
// forces. Velocities are those of half a step before, along straight paths: x × v is the same at both ends of
// a step.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "engine/simulation.hpp"

namespace loam::engine {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Spheres of a dense packing within a ball, in a cell eight times as wide as the ball.
Packing cluster() {
    static const Packing made = [] {
        PackingOptions options;
        options.particles = 200;
        options.target_porosity = 0.42;
        const Packing whole = make_packing(options).packing;
        const Vector3d middle = whole.cell * Vector3d::Constant(0.5);
        std::vector<Eigen::Index> within;
        for (Eigen::Index p = 0; p < whole.radii.size(); ++p)
            if ((whole.centres.col(p) - middle).norm() < 0.4 * whole.cell(0, 0)) within.push_back(p);
        Packing out;
        out.cell = 6 * whole.cell;
        out.centres = whole.centres(Eigen::all, within);
        out.centres.colwise() += Vector3d(2.5 * whole.cell.diagonal());
        out.radii = whole.radii(within);
        return out;
    }();
    return made;
}

Matrix3Xd at_random(Eigen::Index count, double size, unsigned seed) {
    std::mt19937_64 random(seed);
    Matrix3Xd out(3, count);
    for (double& x : out.reshaped()) x = size * (static_cast<double>(random() >> 11) * 0x1.0p-53 - 0.5);
    return out;
}

/// Sums over the particles, and of their parts' sizes, which rounding is measured by.
struct Momenta {
    Vector3d linear = Vector3d::Zero(), angular = Vector3d::Zero();
    double linear_size = 0, angular_size = 0, spin_size = 0;
};

Momenta momenta(const Simulation& simulation) {
    const Packing now = simulation.packing();
    const Matrix3Xd v = simulation.velocities(), spins = simulation.spins();
    Momenta out;
    for (Eigen::Index p = 0; p < now.radii.size(); ++p) {
        const double r = now.radii[p], m = r * r * r;
        const Vector3d of_path = now.centres.col(p).cross(m * v.col(p)),
                       of_spin = 0.4 * m * r * r * spins.col(p);
        out.linear += m * v.col(p);
        out.angular += of_path + of_spin;
        out.linear_size += m * v.col(p).norm();
        out.angular_size += of_path.norm() + of_spin.norm();
        out.spin_size += of_spin.norm();
    }
    return out;
}

struct Case {
    std::string name;
    ContactLaw law;
    bool free_rotation;
    friend void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }
};

std::vector<Case> cases() {
    LinearDamped damped;
    damped.friction_angle = 0.3;
    std::vector<Case> out;
    for (const auto& [name, law] : {std::pair{"LinearCohesive", ContactLaw(LinearCohesive{})},
                                    std::pair{"LinearDamped", ContactLaw(damped)},
                                    std::pair{"HertzMindlin", ContactLaw(HertzMindlin{})}}) {
        out.push_back({std::string(name) + "Blocked", law, false});
        out.push_back({std::string(name) + "Free", law, true});
        out.push_back({std::string(name) + "Resisted", law, true});
        out.back().law.rolling.friction = 0.1;
    }
    return out;
}

class FreeCloud : public testing::TestWithParam<Case> {};

TEST_P(FreeCloud, MomentumAndAngularMomentumStayToRounding) {
    SimulationOptions how;
    how.free_rotation = GetParam().free_rotation;
    how.damping = 0;
    how.energy_balance = true;
    how.time_step_safety = 0.45;  // collisions last long enough to be met
    Simulation simulation(cluster(), GetParam().law, how);
    const Eigen::Index count = cluster().radii.size();
    ASSERT_GT(count, 30);
    const double radius = cluster().radii.mean(), speed = 1e-3 * radius / simulation.time_step();
    const Vector3d middle = cluster().centres.rowwise().mean();
    const Matrix3Xd inward = (cluster().centres.colwise() - middle) * (-0.2 * speed / radius);
    simulation.set_velocities(at_random(count, speed, 1) + inward);
    if (how.free_rotation) simulation.set_spins(at_random(count, speed / radius, 2));
    const Momenta start = momenta(simulation);
    int met = 0;
    for (int k = 0; k < 40; ++k) {
        simulation.advance(50);
        met += simulation.measured().contacts > 0 ? 1 : 0;
        const Momenta now = momenta(simulation);
        EXPECT_LT((now.linear - start.linear).norm(), 1e-13 * now.linear_size) << k;
        // With blocked rotation the frame that holds the particles takes up the couples.
        if (!how.free_rotation) continue;
        EXPECT_LT((now.angular - start.angular).norm(), 1e-13 * now.angular_size) << k;
        EXPECT_GT(now.spin_size, 1e-3 * now.angular_size) << k;  // and spins would be missed
    }
    EXPECT_GT(met, 3);
    EXPECT_GT(simulation.energy().sliding, 0.01 * simulation.energy().stored_start);
    EXPECT_LT(simulation.energy().stored, simulation.energy().stored_start);
}

INSTANTIATE_TEST_SUITE_P(Laws, FreeCloud, testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace loam::engine
