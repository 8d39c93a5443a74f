// What must not matter: the place and the orientation of a packing, its size, and the density of its grains;
// under every law, with dashpots, blocked, free or resisted.
//
// The packing is loaded in compression and shear without damping, with friction, cohesion and a cell that
// shears. Cundall's damping acts on the components of the force, so it knows the axes (Cundall
// 1987): with it only turns that map axes to axes leave the result alone. Rounding grows while contacts open
// and slide; over these 300 steps (strain 6e-4) the tolerance of 1e-9 stands for it, and a single step is
// held to 1e-12.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "engine/loading.hpp"
#include "engine/simulation.hpp"

namespace loam::engine {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Case {
    std::string name;
    ContactLaw law;
    bool free_rotation;
    friend void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }
};

std::vector<Case> cases() {
    std::vector<Case> out;
    for (const auto& [name, law] : {std::pair{"LinearCohesive", ContactLaw(LinearCohesive{})},
                                    std::pair{"LinearDamped", ContactLaw(LinearDamped{})},
                                    std::pair{"HertzMindlin", ContactLaw(HertzMindlin{})}})
        for (const std::string turning : {"Blocked", "Free", "Resisted"}) {
            out.push_back({name + turning, law, turning != "Blocked"});
            if (turning == "Resisted") out.back().law.rolling.friction = 0.1;
        }
    return out;
}

/// A packing at rest with free rotation and the base law: one that yields would magnify rounding.
const Packing& packing_of(const ContactLaw& law) {
    static std::map<std::size_t, Packing> made;
    const auto known = made.find(law.base.index());
    if (known != made.end()) return known->second;
    PackingOptions options;
    options.particles = 200;
    options.target_porosity = 0.44;
    options.seed = 6;
    ContactLaw base = law;
    base.rolling.friction = 0;
    SimulationOptions how;
    how.free_rotation = true;
    Simulation simulation(make_packing(options).packing, base, how);
    ServoOptions servo;
    servo.unbalanced_ratio = 1e-4;
    consolidate(simulation, 3e5, servo);
    return made[law.base.index()] = simulation.packing();
}

Matrix3d loading() {  // strain a step
    Matrix3d gradient;
    gradient << -0.4e-6, 0.3e-6, 0, -0.2e-6, -0.1e-6, 0.5e-6, 0.7e-6, 0, -2e-6;
    return gradient;
}

double deviation(const Matrix3d& a, const Matrix3d& b) {
    return (a - b).norm() / b.norm();
}

class Invariance : public testing::TestWithParam<Case> {
  protected:
    const Packing& packing() const { return packing_of(GetParam().law); }

    Matrix3d stress_after(const Packing& start, const Matrix3d& strain_per_step, int steps,
                          double damping = 0, double density = 2600) const {
        SimulationOptions how;
        how.free_rotation = GetParam().free_rotation;
        how.damping = damping;
        how.grain_density = density;
        Simulation simulation(start, GetParam().law, how);
        simulation.set_velocity_gradient(strain_per_step / simulation.time_step());
        return simulation.advance(steps).stress;
    }
};

TEST_P(Invariance, ATurnedPackingHasTheTurnedStress) {
    for (const Vector3d& axis : {Vector3d(1, 2, -0.5), Vector3d(-1, 0.3, 3)}) {
        const Matrix3d q = Eigen::AngleAxisd(1.1, axis.normalized()).toRotationMatrix();
        Packing turned = packing();
        turned.cell = q * turned.cell;
        turned.centres = q * turned.centres;
        for (const int steps : {1, 300}) {
            const Matrix3d here = stress_after(packing(), loading(), steps);
            const Matrix3d there = stress_after(turned, q * loading() * q.transpose(), steps);
            EXPECT_LT(deviation(there, q * here * q.transpose()), steps == 1 ? 1e-12 : 1e-9) << steps;
        }
    }
}

TEST_P(Invariance, WithDampingATurnOfTheAxesIntoEachOtherDoesNotMatter) {
    Matrix3d q;
    q << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    Packing turned = packing();
    turned.cell = q * turned.cell;
    turned.centres = q * turned.centres;
    const Matrix3d here = stress_after(packing(), loading(), 300, 0.4);
    const Matrix3d there = stress_after(turned, q * loading() * q.transpose(), 300, 0.4);
    EXPECT_LT(deviation(there, q * here * q.transpose()), 1e-9);
}

TEST_P(Invariance, TheChoiceOfTheCellsEdgesDoesNotMatter) {
    // Edges a, b + a, c - b - a span the same lattice of copies as a, b, c.
    Packing other = packing();
    const Matrix3d cell = packing().cell;
    other.cell.col(1) += cell.col(0);
    other.cell.col(2) -= cell.col(1);
    const Matrix3d here = stress_after(packing(), loading(), 300);
    EXPECT_LT(deviation(stress_after(other, loading(), 300), here), 1e-9);
}

TEST_P(Invariance, AMovedPackingHasTheSameStress) {
    Packing moved = packing();
    moved.centres.colwise() += packing().cell * Vector3d(0.37, -1.21, 0.53);
    for (const int steps : {1, 300}) {
        const Matrix3d here = stress_after(packing(), loading(), steps);
        EXPECT_LT(deviation(stress_after(moved, loading(), steps), here), steps == 1 ? 1e-12 : 1e-9);
    }
}

TEST_P(Invariance, TheOrderOfTheParticlesDoesNotMatter) {
    Packing reversed = packing();
    reversed.centres = packing().centres.rowwise().reverse().eval();
    reversed.radii = packing().radii.reverse().eval();
    const Matrix3d here = stress_after(packing(), loading(), 300, 0.4);
    EXPECT_LT(deviation(stress_after(reversed, loading(), 300, 0.4), here), 1e-9);
}

TEST_P(Invariance, LengthsOfAnyScaleGiveTheSameStressAtTheSameStrain) {
    // k ~ E R, adhesion ~ C R^2 and k ~ E sqrt(R u) bring no length of their own, dashpots ~ sqrt(m k) no
    // time; time goes with the length. A power of two changes no bit.
    const Matrix3d here = stress_after(packing(), loading(), 1000, 0.4);
    for (const double scale : {0.125, 64.0}) {
        Packing scaled = packing();
        scaled.cell *= scale;
        scaled.centres *= scale;
        scaled.radii *= scale;
        EXPECT_EQ(stress_after(scaled, loading(), 1000, 0.4), here) << scale;
    }
    Packing scaled = packing();
    scaled.cell *= 0.0137;
    scaled.centres *= 0.0137;
    scaled.radii *= 0.0137;
    EXPECT_LT(
        deviation(stress_after(scaled, loading(), 300, 0.4), stress_after(packing(), loading(), 300, 0.4)),
        1e-9);
}

TEST_P(Invariance, DensityScalesTimeAlone) {
    // Without gravity the density only sets the time step, ~ sqrt(density): the same strain a step gives the
    // same stress. A power of four changes no bit.
    const Matrix3d here = stress_after(packing(), loading(), 1000, 0.4);
    EXPECT_EQ(stress_after(packing(), loading(), 1000, 0.4, 2600 * 16.0), here);
    EXPECT_LT(deviation(stress_after(packing(), loading(), 300, 0.4, 2600 * 1e6 / 3),
                        stress_after(packing(), loading(), 300, 0.4)),
              1e-9);
    SimulationOptions light;
    light.free_rotation = GetParam().free_rotation;
    SimulationOptions heavy = light;
    heavy.grain_density *= 9;
    EXPECT_NEAR(Simulation(packing(), GetParam().law, heavy).time_step() /
                    Simulation(packing(), GetParam().law, light).time_step(),
                3, 1e-14);
}

TEST_P(Invariance, StressesScaleWithTheModulus) {
    // With cohesion over modulus and strain kept, all stresses go with the modulus, Hertzian ones too; a
    // power of two changes no bit.
    ContactLaw stiff = GetParam().law.with_young_modulus(1024 * GetParam().law.young_modulus());
    if (auto* cohesive = std::get_if<LinearCohesive>(&stiff.base)) {
        cohesive->normal_cohesion *= 1024;
        cohesive->shear_cohesion *= 1024;
    }
    SimulationOptions how;
    how.free_rotation = GetParam().free_rotation;
    Simulation a(packing(), GetParam().law, how), b(packing(), stiff, how);
    for (Simulation* s : {&a, &b}) {
        s->set_velocity_gradient(loading() / s->time_step());
        s->advance(1000);
    }
    EXPECT_EQ(Matrix3d(a.measured().stress * 1024), b.measured().stress);
}

INSTANTIATE_TEST_SUITE_P(Laws, Invariance, testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace loam::engine
