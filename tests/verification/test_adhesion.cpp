// Adhesion of the law `linear-cohesive` (De Pue et al. 2019, eqs 1, 3 and 7; fragile bonds after Bourrier et
// al. 2013) on two spheres of unequal size that are moved by hand.
//
// a_n = C_n min(R_1, R_2)^2 is the largest tension and is reached at the gap a_n / k_n; the shear force is
// limited by max(0, F_n tan(phi) + a_t), a_t = C_t min(R_1, R_2)^2. Tolerance: 1e-7 of the force where a
// position is reached and held (the rounding of a distance of 0.07 m over an overlap of some 1e-5 m); one
// increment of motion where a limit is passed.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/verification/two_spheres.hpp"

namespace loam::engine {
namespace {

using Eigen::Vector3d;

constexpr double modulus = 1e8, radius_0 = 0.05, radius_1 = 0.02;
constexpr double normal_cohesion = 2e4, shear_cohesion = 3e4, friction = 0.4;
constexpr double a_n = normal_cohesion * radius_1 * radius_1, a_t = shear_cohesion * radius_1 * radius_1;

class Adhesion : public testing::Test {
  protected:
    explicit Adhesion(bool fragile = true) {
        law.normal_cohesion = normal_cohesion;
        law.shear_cohesion = shear_cohesion;
        law.friction_angle = std::atan(friction);
        law.stiffness_ratio = 0.4;
        law.fragile = fragile;
        pair.radius_0 = radius_0;
        pair.radius_1 = radius_1;
        pair.safety = 1e-5;
        pair.gap = -parting_gap;
    }
    double k() const { return series_stiffness(modulus, radius_0, radius_1); }
    static double force_along(TwoSpheres& spheres, const Vector3d& n, double gap) {
        return -spheres.move_to((spheres.radius_sum() + gap) * n)
                    .dot(n);  // on the second: compression positive
    }
    /// Moves on the sphere around the first, so that the overlap is kept; returns the shear force on the
    /// first.
    static Vector3d shear_to(TwoSpheres& spheres, double gap, const Vector3d& n, const Vector3d& t,
                             double path) {
        const double angle = path / spheres.radius_sum();
        const Vector3d now = std::cos(angle) * n + std::sin(angle) * t;
        const Vector3d force = spheres.move_to((spheres.radius_sum() + gap) * now);
        return force - force.dot(now) * now;
    }

    LinearCohesive law = elastic_law(modulus);
    PairOptions pair;
    const double parting_gap = a_n / series_stiffness(modulus, radius_0, radius_1);
    const Vector3d n = pair.direction, t = n.cross(Vector3d::UnitX()).normalized();
};

class LastingAdhesion : public Adhesion {
  protected:
    LastingAdhesion() : Adhesion(false) {}
};

TEST_F(Adhesion, TensionPeaksAtCohesionTimesTheSquareOfTheSmallerRadius) {
    TwoSpheres spheres(law, pair);
    double peak = 0, last_held = 0;
    for (int step = -200; step < 300; ++step) {  // gaps from -1 to 1.5 of the parting gap
        const double gap = step / 200.0 * parting_gap, force = force_along(spheres, n, gap);
        if (spheres.simulation.measured().contacts > 0) {
            EXPECT_NEAR(force, -k() * gap, 1e-7 * a_n);
            last_held = gap;
        } else {
            EXPECT_EQ(force, 0);
        }
        peak = std::min(peak, force);
    }
    EXPECT_NEAR(-peak, a_n, a_n / 200);
    EXPECT_NEAR(last_held, parting_gap, parting_gap / 200);
}

TEST_F(Adhesion, ATornBondComesBackOnlyAfterTouchingAgain) {
    TwoSpheres spheres(law, pair);
    EXPECT_NEAR(force_along(spheres, n, 0.9 * parting_gap), -0.9 * a_n, 1e-7 * a_n);
    EXPECT_EQ(force_along(spheres, n, 1.1 * parting_gap), 0);  // torn
    for (const double gap : {0.9, 0.5, 0.01}) EXPECT_EQ(force_along(spheres, n, gap * parting_gap), 0) << gap;
    EXPECT_NEAR(force_along(spheres, n, -0.5 * parting_gap), 0.5 * a_n, 1e-7 * a_n);  // touching: renewed
    EXPECT_NEAR(force_along(spheres, n, 0.9 * parting_gap), -0.9 * a_n, 1e-7 * a_n);
}

TEST_F(Adhesion, ABondBrokenByShearHoldsNoTensionUntilRenewed) {
    TwoSpheres spheres(law, pair);
    const double overlap = parting_gap, normal = k() * overlap;
    const double kt = law.stiffness_ratio * k(), slip = 2 * (normal * friction + a_t) / kt;
    force_along(spheres, n, -overlap);
    const double held = shear_to(spheres, -overlap, n, t, slip).norm();
    EXPECT_NEAR(held, normal * friction, 1e-6 * normal);
    const Vector3d now = spheres.branch().normalized();
    EXPECT_NEAR(force_along(spheres, now, -0.5 * overlap), 0.5 * normal, 1e-6 * normal);  // still touching
    EXPECT_EQ(force_along(spheres, now, 0.1 * parting_gap), 0);
    EXPECT_NEAR(force_along(spheres, now, -0.1 * overlap), 0.1 * normal, 1e-6 * normal);
    EXPECT_NEAR(force_along(spheres, now, 0.9 * parting_gap), -0.9 * a_n, 1e-6 * a_n);
}

TEST_F(Adhesion, FragileShearPeaksAtFrictionPlusAdhesionAndFallsToFriction) {
    // In compression, almost unloaded, and in tension, where F_n tan(phi) lowers the limit.
    for (const double overlap : {parting_gap, 0.001 * parting_gap, -0.6 * parting_gap}) {
        TwoSpheres spheres(law, pair);
        force_along(spheres, n, -parting_gap);
        if (overlap < parting_gap) force_along(spheres, n, -overlap);
        const double normal = k() * overlap, limit = normal * friction + a_t;
        const double kt = law.stiffness_ratio * k(), increment = limit / kt / 100;
        double peak = 0;
        Vector3d shear = Vector3d::Zero();
        for (int step = 1; step <= 150; ++step) {
            shear = shear_to(spheres, -overlap, n, t, step * increment);
            if (step < 100) {
                // On the first sphere, towards where the second goes.
                EXPECT_NEAR(shear.dot(t), kt * step * increment, 1e-3 * limit) << overlap << " " << step;
            }
            peak = std::max(peak, shear.norm());
        }
        EXPECT_NEAR(peak, limit, 0.011 * limit) << overlap;
        EXPECT_NEAR(shear.norm(), std::max(0.0, normal * friction), 1e-6 * limit) << overlap;
    }
}

TEST_F(LastingAdhesion, TensionStaysAtTheAdhesionUpToTheInteractionRange) {
    law.interaction_range = 1.3;
    TwoSpheres spheres(law, pair);
    const double range = 0.3 * (radius_0 + radius_1);
    EXPECT_NEAR(force_along(spheres, n, 0.5 * parting_gap), -0.5 * a_n, 1e-7 * a_n);
    for (const double gap : {1.001 * parting_gap, 10 * parting_gap, 0.01 * range, 0.5 * range, 0.999 * range})
        EXPECT_NEAR(force_along(spheres, n, gap), -a_n, 1e-7 * a_n) << gap;
    // The force is one of the gap alone: on the way back it is the same.
    EXPECT_NEAR(force_along(spheres, n, 0.5 * parting_gap), -0.5 * a_n, 1e-7 * a_n);
    EXPECT_NEAR(force_along(spheres, n, 0.999 * range), -a_n, 1e-7 * a_n);
    EXPECT_EQ(force_along(spheres, n, 1.001 * range), 0);
    EXPECT_EQ(force_along(spheres, n, 0.5 * range), 0);
    EXPECT_NEAR(force_along(spheres, n, -0.1 * parting_gap), 0.1 * a_n, 1e-7 * a_n);
    EXPECT_NEAR(force_along(spheres, n, 0.5 * range), -a_n, 1e-7 * a_n);
}

TEST_F(LastingAdhesion, ShearStaysAtFrictionPlusAdhesion) {
    for (const double overlap : {parting_gap, -0.6 * parting_gap}) {
        TwoSpheres spheres(law, pair);
        force_along(spheres, n, -parting_gap);
        if (overlap < parting_gap) force_along(spheres, n, -overlap);
        const double limit = k() * overlap * friction + a_t, reach = limit / (law.stiffness_ratio * k());
        for (const double path : {1.01 * reach, 1.5 * reach, 4 * reach})
            EXPECT_NEAR(shear_to(spheres, -overlap, n, t, path).norm(), limit, 1e-6 * limit) << overlap;
    }
}

TEST_F(LastingAdhesion, AViewOfAContactShowsTheForceThatActs) {
    TwoSpheres spheres(law, pair);
    force_along(spheres, n, -0.5 * parting_gap);
    for (const double gap : {-0.3 * parting_gap, 0.5 * parting_gap, 20 * parting_gap}) {
        const double force = force_along(spheres, n, gap);
        ASSERT_EQ(spheres.simulation.contacts().size(), 1u);
        EXPECT_NEAR(spheres.simulation.contacts()[0].normal_force, force, 1e-6 * a_n) << gap;
    }
}

TEST_F(Adhesion, TearingABondTakesTheEnergyItHeld) {
    // a_n^2 / (2 k_n), from the motion and as the loss that the balance reports; tolerance: the gap grows by
    // v dt beyond the limit in the last step, some 2 v dt / parting gap of the energy.
    pair.safety = 1e-3;
    pair.gap = -1e-3 * parting_gap;
    TwoSpheres spheres(law, pair);
    const double m = effective_mass(radius_0, radius_1, spheres.simulation.grain_density()),
                 held = 0.5 * a_n * parting_gap;
    const double v = std::sqrt(4 * held / m);
    spheres.set_relative_velocity(v * n);
    spheres.collide();
    const double tolerance = 2 * v * spheres.simulation.time_step() / parting_gap + 1e-5;
    EXPECT_LT(tolerance, 0.01);
    EXPECT_NEAR((0.5 * m * v * v - spheres.energy_of_translation()) / held, 1, tolerance);
    EXPECT_NEAR(spheres.simulation.energy().sliding / held, 1, tolerance);
}

/// Pulls a lasting bond apart with twice the energy that its plateau takes.
struct PullingOut {
    double taken, booked;  // from the motion, and as the engine books it, over the closed form
};

PullingOut pull_out(LinearCohesive law, PairOptions pair, double parting_gap) {
    law.interaction_range = 1.001;
    pair.safety = 1e-3;
    pair.gap = -1e-3 * parting_gap;
    TwoSpheres spheres(law, pair);
    const double range = 0.001 * (radius_0 + radius_1), held = a_n * range - 0.5 * a_n * parting_gap;
    const double m = effective_mass(radius_0, radius_1, spheres.simulation.grain_density());
    const double v = std::sqrt(4 * held / m);
    spheres.set_relative_velocity(v * pair.direction);
    spheres.collide();
    return {(0.5 * m * v * v - spheres.energy_of_translation()) / held,
            spheres.simulation.energy().sliding / held};
}

TEST_F(LastingAdhesion, PullingOutTakesTheEnergyOfThePlateau) {
    // a_n range - a_n^2 / (2 k_n): the spring up to a_n, then a_n up to the range. Tolerance: one step, v dt
    // / range.
    EXPECT_NEAR(pull_out(law, pair, parting_gap).taken, 1, 1e-3);
}

// Disabled: at the end of the range the engine books k_n range^2 / 2, as if the spring had gone on.
TEST_F(LastingAdhesion, PullingOutIsBookedAsTheEnergyOfThePlateau) {
    EXPECT_NEAR(pull_out(law, pair, parting_gap).booked, 1, 1e-3);
}

}  // namespace
}  // namespace loam::engine
