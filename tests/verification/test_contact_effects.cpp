// The effects adhesion, hertzian_stiffness, capillarity, cementation and plastic_contact on two spheres of
// unequal size that are moved by hand, on every base law. Closed forms, with a = min(R_1, R_2)²:
//
//   adhesion, cementation: tension up to stress · a; shear up to F_n tan(phi) + ratio · stress · a
//   hertzian_stiffness: F = k u ((1 - s) + 2/3 s sqrt(u/u*)), tangent k at the force 4 P a
//   plastic_contact: unloading along k/(1 - s) from s u_m; a cycle loses s of the loading's work; the
//     restitution of a head-on impact is sqrt(1 - s)                       (Walton and Braun 1986)
//   capillarity: see test_capillarity.cpp
//
// Tolerance 1e-6 of the force where a position is reached and held (rounding of the distance over the
// overlap), one increment of motion where a limit is passed.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tests/verification/two_spheres.hpp"

namespace loam::engine {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double radius_0 = 0.05, radius_1 = 0.02, area = radius_1 * radius_1;
constexpr double sum = radius_0 + radius_1, reach = 2e-4 * sum, friction = 0.4;

ContactLaw base_law(int which) {
    if (which == 0) {
        LinearCohesive law;
        law.young_modulus = 1e8;
        law.normal_cohesion = law.shear_cohesion = 0;
        law.friction_angle = std::atan(friction);
        return law;
    }
    if (which == 1) {
        LinearDamped law;
        law.young_modulus = 1e8;
        law.friction_angle = std::atan(friction);
        law.normal_damping = law.tangential_damping = 0;
        return law;
    }
    HertzMindlin law;
    law.young_modulus = 1e10;
    law.friction_angle = std::atan(friction);
    law.restitution = 1;
    return law;
}

/// By base law, and with free rotation or not.
class Effects : public testing::TestWithParam<std::tuple<int, bool>> {
  protected:
    Effects() : law(base_law(std::get<0>(GetParam()))) {
        pair.radius_0 = radius_0;
        pair.radius_1 = radius_1;
        pair.gap = -1e-9;
        pair.safety = 1e-7;
        pair.free_rotation = std::get<1>(GetParam());
        pair.largest_overlap = 1e-3;
    }
    bool hertz() const { return std::get<0>(GetParam()) == 2; }
    /// The base law's force at an overlap (N).
    double spring(double u) const {
        const double reduced = radius_0 * radius_1 / sum;
        if (hertz()) return 2.0 / 3 * 1e10 / (1 - 0.09) * std::sqrt(reduced) * std::pow(u, 1.5);
        return u * (std::get<0>(GetParam()) == 0 ? 2e8 * reduced : 0.25 * pi * 1e8 * sum);
    }
    double energy(double u) const { return (hertz() ? 0.4 : 0.5) * u * spring(u); }
    /// On the second, compression positive.
    double force_at(TwoSpheres& spheres, double overlap) const {
        return -spheres.move_to((sum - overlap) * n).dot(n);
    }
    /// Moves on the sphere around the first; the shear force on the first.
    double shear_at(TwoSpheres& spheres, double overlap, double path) const {
        const Vector3d now = std::cos(path / sum) * n + std::sin(path / sum) * t;
        const Vector3d force = spheres.move_to((sum - overlap) * now);
        return (force - force.dot(now) * now).norm();
    }
    /// Half the tension's limit is reached at a gap of about reach / 4.
    double stress() const { return spring(0.5 * reach) / area; }

    ContactLaw law;
    PairOptions pair;
    const Vector3d n = pair.direction, t = n.cross(Vector3d::UnitX()).normalized();
};

TEST_P(Effects, AdhesionHoldsItsStressTimesTheSquareOfTheSmallerRadius) {
    law.adhesion = {.stress = stress(), .shear_ratio = 2};
    TwoSpheres spheres(law, pair);
    double peak = 0;
    for (int step = 200; step > -200; --step) {
        const double overlap = step / 200.0 * reach, force = force_at(spheres, overlap);
        if (overlap > -0.499 * reach) {
            EXPECT_NEAR(force, std::copysign(spring(std::abs(overlap)), overlap), 1e-6 * spring(reach));
        } else if (overlap < -0.501 * reach) {
            EXPECT_EQ(force, 0);
        }
        peak = std::min(peak, force);
    }
    EXPECT_NEAR(-peak, stress() * area, 0.02 * stress() * area);
}

TEST_P(Effects, AdhesionIsRenewedByTouchingAlone) {
    law.adhesion = {.stress = stress(), .shear_ratio = 2};
    TwoSpheres spheres(law, pair);
    for (int turn = 0; turn < 3; ++turn) {
        EXPECT_NEAR(force_at(spheres, 0.3 * reach), spring(0.3 * reach), 1e-6 * spring(reach));
        EXPECT_NEAR(force_at(spheres, -0.4 * reach), -spring(0.4 * reach), 1e-6 * spring(reach));
        EXPECT_EQ(force_at(spheres, -0.6 * reach), 0);
        EXPECT_EQ(force_at(spheres, -0.1 * reach), 0);
    }
}

TEST_P(Effects, AdhesionAddsToFrictionUntilTheShearBreaksIt) {
    law.adhesion = {.stress = stress(), .shear_ratio = 2};
    TwoSpheres spheres(law, pair);
    const double overlap = 0.5 * reach, normal = spring(overlap),
                 limit = friction * normal + 2 * stress() * area;
    force_at(spheres, overlap);
    double peak = 0, last = 0;
    const double increment = 0.01 * reach;
    for (int step = 1; step < 2000; ++step) {
        last = shear_at(spheres, overlap, step * increment);
        peak = std::max(peak, last);
        if (last < 0.9 * peak) break;
    }
    EXPECT_NEAR(peak, limit, 0.03 * limit);
    EXPECT_LT(peak, limit * (1 + 1e-6));
    EXPECT_NEAR(last, friction * normal, 1e-4 * limit);
}

TEST_P(Effects, CementBreaksAtItsStrengthAndNeverHeals) {
    law.cementation = {.strength = stress(), .shear_ratio = 2};
    TwoSpheres spheres(law, pair);
    force_at(spheres, 0.2 * reach);
    EXPECT_EQ(spheres.simulation.cement_contacts(), 1u);
    EXPECT_EQ(spheres.simulation.measured().broken_bond_ratio, 0);
    EXPECT_NEAR(force_at(spheres, -0.499 * reach), -spring(0.499 * reach), 1e-6 * spring(reach));
    EXPECT_EQ(spheres.simulation.measured().broken_bond_ratio, 0);
    EXPECT_EQ(force_at(spheres, -0.501 * reach), 0);
    EXPECT_EQ(spheres.simulation.measured().broken_bond_ratio, 1);
    EXPECT_NEAR(force_at(spheres, 0.2 * reach), spring(0.2 * reach), 1e-6 * spring(reach));
    EXPECT_EQ(force_at(spheres, -0.01 * reach), 0);
    EXPECT_EQ(spheres.simulation.measured().broken_bond_ratio, 1);
}

TEST_P(Effects, CementBreaksInShearToo) {
    law.cementation = {.strength = stress(), .shear_ratio = 2};
    TwoSpheres spheres(law, pair);
    const double overlap = 0.5 * reach, normal = spring(overlap),
                 limit = friction * normal + 2 * stress() * area;
    force_at(spheres, overlap);
    spheres.simulation.cement_contacts();
    double peak = 0, last = 0;
    for (int step = 1; step < 2000; ++step) {
        last = shear_at(spheres, overlap, 0.01 * reach * step);
        peak = std::max(peak, last);
        EXPECT_EQ(spheres.simulation.measured().broken_bond_ratio, last < peak ? 1 : 0);
        if (last < peak) break;
    }
    EXPECT_NEAR(peak, limit, 0.03 * limit);
    EXPECT_LT(peak, limit * (1 + 1e-6));
    EXPECT_NEAR(last, friction * normal, 1e-4 * limit);
}

TEST_P(Effects, OnlyContactsThatArePresentAreCemented) {
    law.cementation = {.strength = stress(), .shear_ratio = 2};
    TwoSpheres spheres(law, pair);
    EXPECT_EQ(force_at(spheres, -0.1 * reach), 0);
    EXPECT_EQ(spheres.simulation.cement_contacts(), 0u);
    force_at(spheres, 0.2 * reach);
    EXPECT_EQ(force_at(spheres, -0.1 * reach), 0);
}

TEST_P(Effects, PlasticContactUnloadsFromThePermanentOverlap) {
    const double share = 0.4;
    law.plastic.share = share;
    TwoSpheres spheres(law, pair);
    const double tolerance = 1e-6 * spring(reach);
    for (const double overlap : {0.1, 0.5, 1.0})
        EXPECT_NEAR(force_at(spheres, overlap * reach), spring(overlap * reach), tolerance);
    // Down, up and beyond; in the end the grains part and the contact is as new.
    for (const double overlap : {0.9, 0.6, 0.41, 0.7, 1.0})
        EXPECT_NEAR(force_at(spheres, overlap * reach), spring((overlap - share) / (1 - share) * reach),
                    tolerance);
    for (const double overlap : {0.39, 0.1}) EXPECT_EQ(force_at(spheres, overlap * reach), 0);
    EXPECT_EQ(spheres.simulation.measured().contacts, 0);
    EXPECT_NEAR(force_at(spheres, 0.7 * reach), spring(0.5 * reach), tolerance);
    EXPECT_NEAR(force_at(spheres, 1.2 * reach), spring(1.2 * reach), tolerance);
    EXPECT_NEAR(force_at(spheres, 0.6 * reach), spring(0.2 * reach), tolerance);
    force_at(spheres, -0.1 * reach);
    EXPECT_NEAR(force_at(spheres, 0.1 * reach), spring(0.1 * reach), tolerance);
}

TEST_P(Effects, PlasticContactLosesItsShareOfTheWorkOfLoading) {
    law.plastic.share = 0.4;
    TwoSpheres spheres(law, pair);
    force_at(spheres, reach);
    EXPECT_NEAR(spheres.simulation.energy().sliding, 0.4 * energy(reach), 1e-5 * energy(reach));
    EXPECT_NEAR(spheres.simulation.measured().elastic_energy, 0.6 * energy(reach), 1e-5 * energy(reach));
    for (const double overlap : {0.5, 0.9, 0.5, 1.0}) force_at(spheres, overlap * reach);
    EXPECT_NEAR(spheres.simulation.energy().sliding, 0.4 * energy(reach), 1e-5 * energy(reach));
    force_at(spheres, 2 * reach);
    EXPECT_NEAR(spheres.simulation.energy().sliding, 0.4 * energy(2 * reach), 1e-5 * energy(2 * reach));
}

TEST_P(Effects, PlasticImpactKeepsTheRootOfWhatIsLeft) {
    for (const double share : {0.2, 0.6}) {
        law.plastic.share = share;
        pair.gap = 1e-9;
        pair.safety = 0.002;
        TwoSpheres spheres(law, pair);
        spheres.set_relative_velocity(-0.05 * n);
        spheres.collide();
        EXPECT_NEAR(spheres.relative_velocity().dot(n) / 0.05, std::sqrt(1 - share), 1e-3);
    }
}

TEST_P(Effects, HertzianStiffnessIsTheLinearOneAtTheReferencePressure) {
    if (hertz()) {
        law.hertzian.share = 0.5;
        EXPECT_THROW(TwoSpheres(law, pair), std::invalid_argument);
        return;
    }
    for (const double share : {0.3, 1.0}) {
        law.hertzian = {.share = share, .reference_pressure = spring(reach) / (4 * area)};
        TwoSpheres spheres(law, pair);
        const double at = reach / (1 - share / 3), k = spring(1), h = 0.01 * reach;  // u*
        EXPECT_NEAR(force_at(spheres, at), spring(reach), 1e-6 * spring(reach));
        EXPECT_NEAR((force_at(spheres, at + h) - force_at(spheres, at - h)) / (2 * h), k, 1e-4 * k);
        for (const double overlap : {0.05, 0.3, 2.0}) {
            const double u = overlap * reach;
            EXPECT_NEAR(force_at(spheres, u), k * u * (1 - share + 2.0 / 3 * share * std::sqrt(u / at)),
                        1e-6 * spring(2 * reach));
        }
        if (share < 1) continue;
        EXPECT_NEAR(force_at(spheres, 2 * reach) / force_at(spheres, 0.5 * reach), 8, 1e-4);  // power 3/2
    }
}

TEST_P(Effects, ForceIsTheSlopeOfTheStoredEnergy) {
    // In compression and tension, all effects together, after loading to `reach`. Central differences: 1e-4.
    const double share = 0.4;
    law.adhesion.stress = stress();
    law.plastic.share = share;
    law.capillarity.suction = 0.2 * stress();
    law.cementation.strength = 0.5 * stress();
    if (!hertz()) law.hertzian = {.share = 0.6, .reference_pressure = spring(reach) / (4 * area)};
    TwoSpheres spheres(law, pair);
    force_at(spheres, reach);
    spheres.simulation.cement_contacts();
    for (const double overlap : {0.9, 0.5, 0.3, 0.2}) {
        const double h = 0.002 * reach, at = overlap * reach;
        const auto energy_at = [&](double u) {
            force_at(spheres, u);
            return spheres.simulation.measured().elastic_energy;
        };
        const double slope = (energy_at(at + h) - energy_at(at - h)) / (2 * h);
        EXPECT_NEAR(slope, force_at(spheres, at), 1e-4 * spring(reach)) << overlap;
        EXPECT_EQ(spheres.simulation.measured().broken_bond_ratio, 0);
    }
    EXPECT_LT(force_at(spheres, 0.2 * reach), 0);
}

std::string name_of(const testing::TestParamInfo<std::tuple<int, bool>>& info) {
    constexpr std::array laws{"LinearCohesive", "LinearDamped", "HertzMindlin"};
    const auto [law, free] = info.param;
    return std::string(laws[static_cast<std::size_t>(law)]) + (free ? "Free" : "Blocked");
}

INSTANTIATE_TEST_SUITE_P(Laws, Effects, testing::Combine(testing::Values(0, 1, 2), testing::Bool()), name_of);

}  // namespace
}  // namespace loam::engine
