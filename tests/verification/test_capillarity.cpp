// Liquid bridges on two spheres that are moved by hand, against the formulas of their sources, written out
// here from the radii of the meniscus:
//
//   at contact pi r2² s + 2 pi r2 T with s = T (1/r1 - 1/r2)              (Fisher 1926; Jiang and Yu
//   2006, 3.2) across a gap D: F_c (1 - 1/sqrt(1 + 2 V/(pi R D²)))                   (Pitois et al. 2000)
//   rupture at D = V^(1/3)                                               (Lian et al. 1993)
//
// R is twice the reduced radius. Tolerance 1e-6 of the force at contact: rounding of the distance.
#include <gtest/gtest.h>

#include "tests/verification/two_spheres.hpp"

namespace loam::engine {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

struct Bridge {
    Bridge(double suction, double angle, double radius) : r(radius) {
        const double r1 = r * (1 / std::cos(angle) - 1), r2 = r * (1 + std::tan(angle) - 1 / std::cos(angle));
        const double tension = suction / (1 / r1 - 1 / r2);
        contact = pi * r2 * r2 * suction + 2 * pi * r2 * tension;
        volume = 2 * pi * r * r1 * r1 * (1 - (0.5 * pi - angle) * std::tan(angle));
        rupture = std::cbrt(volume);
        around_gorge = contact / (2 * pi * r * tension);
    }
    double at(double gap) const {
        return gap > 0 ? contact * (1 - 1 / std::sqrt(1 + 2 * volume / (pi * r * gap * gap))) : contact;
    }
    /// Work from contact to rupture, by Simpson's rule.
    double work() const {
        const int parts = 2000;
        double total = at(0) + at(rupture);
        for (int k = 1; k < parts; ++k) total += (k % 2 == 1 ? 4 : 2) * at(rupture * k / parts);
        return total * rupture / parts / 3;
    }
    double r, contact, volume, rupture, around_gorge;
};

ContactLaw law_without_shear(int which) {
    if (which == 0) return elastic_law(1e8);
    if (which == 1) {
        LinearDamped law;
        law.normal_damping = law.tangential_damping = law.friction_angle = 0;
        return law;
    }
    HertzMindlin law;
    law.friction_angle = 0;
    law.restitution = 1;
    return law;
}

class Capillary : public testing::TestWithParam<int> {
  protected:
    Capillary() : law(law_without_shear(GetParam())) {
        law.capillarity = {.suction = 2e4, .filling_angle = 0.3};
        pair.radius_0 = 0.05;
        pair.radius_1 = 0.02;
        pair.gap = 1e-6;
        pair.safety = 1e-7;
        pair.largest_overlap = 1e-3;
    }
    double force_at(TwoSpheres& spheres, double gap) const {
        return -spheres.move_to((0.07 + gap) * n).dot(n);  // on the second: compression positive
    }
    ContactLaw law;
    PairOptions pair;
    const Vector3d n = pair.direction;
    const Bridge bridge{2e4, 0.3, 2 * 0.05 * 0.02 / 0.07};
};

TEST_P(Capillary, BridgeHasTheForceOfItsMeniscusAndRupturesAtTheRootOfItsVolume) {
    // Fisher's force is below 2 pi R T, its limit for little liquid, and not by much.
    EXPECT_LT(bridge.around_gorge, 1);
    EXPECT_GT(bridge.around_gorge, 0.8);
    TwoSpheres spheres(law, pair);
    EXPECT_EQ(force_at(spheres, 1e-6), 0);  // no touch, no bridge
    for (int turn = 0; turn < 2; ++turn) {
        force_at(spheres, -1e-8);
        for (const double part : {0.0, 1e-3, 0.05, 0.2, 0.5, 0.9, 0.999})
            EXPECT_NEAR(force_at(spheres, part * bridge.rupture), -bridge.at(part * bridge.rupture),
                        1e-5 * bridge.contact)
                << part;
        EXPECT_EQ(force_at(spheres, 1.001 * bridge.rupture), 0);
        EXPECT_EQ(force_at(spheres, 0.5 * bridge.rupture), 0);  // forms anew at the next touch alone
    }
}

TEST_P(Capillary, BridgePressesTheSpringWhereGrainsTouch) {
    TwoSpheres dry(law_without_shear(GetParam()), pair), wet(law, pair);
    for (const double overlap : {1e-6, 1e-5, 5e-5})
        EXPECT_NEAR(force_at(wet, -overlap), force_at(dry, -overlap) - bridge.contact,
                    1e-6 * (bridge.contact + std::abs(force_at(dry, -overlap))));
    EXPECT_EQ(wet.simulation.measured().contacts, 1);
    force_at(wet, 1e-5);
    EXPECT_EQ(wet.simulation.measured().contacts, 0);  // a bridge across a gap is no contact
}

TEST_P(Capillary, ForceIsTheSlopeOfTheStoredEnergyAndRuptureLosesTheWork) {
    TwoSpheres spheres(law, pair);
    force_at(spheres, -1e-5);
    for (const double gap : {-5e-6, 0.1 * bridge.rupture, 0.6 * bridge.rupture}) {
        // The spring ends where it is without force, with nothing left to lose.
        if (gap > 0) force_at(spheres, 1e-11);
        const double h = 0.02 * std::abs(gap);
        const auto energy_at = [&](double g) {
            force_at(spheres, g);
            return spheres.simulation.measured().elastic_energy;
        };
        const double slope = (energy_at(gap + h) - energy_at(gap - h)) / (2 * h);
        const double force = force_at(spheres, gap);
        EXPECT_NEAR(-slope, force, 1e-3 * std::max(bridge.contact, std::abs(force))) << gap;
    }
    const double before = spheres.simulation.energy().sliding;
    EXPECT_NEAR(before, 0, 1e-6 * bridge.work());
    force_at(spheres, 1.0001 * bridge.rupture);
    EXPECT_NEAR(spheres.simulation.energy().sliding, bridge.work(), 1e-3 * bridge.work());
    EXPECT_EQ(spheres.simulation.measured().elastic_energy, 0);
}

TEST_P(Capillary, FrictionGoesWithTheForceOfTheSpring) {
    // Where spring and bridge balance the net force is nil, and the grains still resist sliding (Jiang and
    // Yu 2006: the bridge's slider).
    std::visit([](auto& base) { base.friction_angle = std::atan(0.4); }, law.base);
    TwoSpheres spheres(law, pair);
    const double overlap = 2e-5, net = force_at(spheres, -overlap), spring = net + bridge.contact;
    const Vector3d t = n.cross(Vector3d::UnitX()).normalized(), now = (n + 0.02 * t).normalized();
    const Vector3d force = spheres.move_to((0.07 - overlap) * now);
    EXPECT_NEAR((force - force.dot(now) * now).norm(), 0.4 * spring, 1e-4 * spring);
}

INSTANTIATE_TEST_SUITE_P(Laws, Capillary, testing::Values(0, 1, 2));

}  // namespace
}  // namespace loam::engine
