// Oblique impact of two equal spheres with linear springs, rotations blocked and free: the laws
// linear-cohesive, and linear-damped without its dashpots (with them: test_oblique_further_laws.cpp).
//
// Dimensionless, after Maw, Barber & Fawcett (1976), Walton (1993) and Di Renzo & Di Maio (2004): q = k_t /
// k_n, V = v_t / (mu v_n) with v_t the tangential velocity of the contact point, time in 1 / sqrt(k_n /
// m_eff), f = F_t / (mu v_n sqrt(k_n m_eff)). The normal force is sin(t) for 0 < t < pi and
//   dV/dt = -c f,  df/dt = q V as long as |f| < sin t, else f = sin t · sign,
// where c = 1 with blocked rotation and 1 + m R^2 / I = 7/2 with free rotation of solid spheres.
//   - Sticking, without a limit of the shear force: V(pi) = V(0) cos(pi sqrt(c q)).
//   - Gross sliding: f = sin t throughout, so V(pi) = V(0) - 2 c; the tangential impulse is mu times the
//     normal one. It begins at once when q V > 1, and lasts as long as the spring would be stretched faster
//     than the limit falls: q (V - c (1 - cos t)) > cos t, a straight line in cos t, so that the ends decide:
//     V > 1/q and V > 2 c - 1/q.
//   - Between the two the equations above are integrated here, with steps so small that their error is below
//     1e-4.
// The centres lose the impulse over m_eff, a part 1/c of the change of V, and each sphere gains the spin
// impulse · R / I. Overlaps are 1e-7 R, so that the normal turns by 1e-7 v_t / v_n rad or so during the
// impact. With h = sqrt(k_n / m_eff) dt = 0.007 the normal impulse is exact to h^2 / 8 (see
// test_normal_impact.cpp).
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "tests/verification/two_spheres.hpp"

namespace loam::engine {
namespace {

using Eigen::Vector3d;

constexpr double modulus = 1e8, density = 2600, pi = std::numbers::pi;

struct Rebound : ObliqueRebound {
    double step_angle;  // sqrt(k_n / m_eff) dt
};

double normal_stiffness(const ContactLaw& law, const PairOptions& o) {
    return std::holds_alternative<LinearDamped>(law.base) ? 0.25 * pi * modulus * (o.radius_0 + o.radius_1)
                                                          : series_stiffness(modulus, o.radius_0, o.radius_1);
}

Rebound collide(const ContactLaw& law, const PairOptions& pair, double tangential_over_normal) {
    const double w =
        std::sqrt(normal_stiffness(law, pair) / effective_mass(pair.radius_0, pair.radius_1, density));
    const double speed = 1e-7 * std::min(pair.radius_0, pair.radius_1) * w;
    const ObliqueRebound out = collide_obliquely(law, pair, speed, tangential_over_normal);
    return {out, w * out.time_step};
}

/// V at the end of the impact, by the equations at the top of this file.
double integrated_rebound(double v, double q, double c) {
    const int steps = 200000;
    const double dt = pi / steps;
    double f = 0;
    for (int n = 0; n < steps; ++n) {
        const double half = v - 0.5 * dt * c * f;
        const double limit = std::sin((n + 1) * dt);
        f = std::clamp(f + dt * q * half, -limit, limit);
        v = half - 0.5 * dt * c * f;
    }
    return v;
}

class ObliqueImpact : public testing::TestWithParam<std::tuple<bool, bool>> {
  protected:
    bool turns() const { return std::get<0>(GetParam()); }
    bool damped_law() const { return std::get<1>(GetParam()); }
    ContactLaw sliding_law(double friction, double stiffness_ratio, double shear_cohesion = 0) const {
        if (damped_law()) {
            LinearDamped law;
            law.young_modulus = modulus;
            law.friction_angle = std::atan(shear_cohesion > 0 ? 1e5 : friction);
            law.stiffness_ratio = stiffness_ratio;
            law.normal_damping = law.tangential_damping = 0;
            return law;
        }
        LinearCohesive law = elastic_law(modulus);
        law.friction_angle = std::atan(friction);
        law.stiffness_ratio = stiffness_ratio;
        law.shear_cohesion = shear_cohesion;
        return law;
    }
    PairOptions pair() const {
        PairOptions o;
        o.free_rotation = turns();
        return o;
    }
    double c() const { return turns() ? 3.5 : 1.0; }
    /// Rotational energy for a change j of the tangential velocity of the centres, over m_eff: each sphere
    /// has the spin m_eff j R / I, and m_eff = m / 2, I = 2/5 m R^2.
    double rotation_for(double j) const { return turns() ? 1.25 * j * j : 0.0; }
};

TEST_P(ObliqueImpact, StickingContactsSwingLikeTwoCoupledOscillators) {
    // The limit of the shear force is put out of reach, by shear cohesion or by a friction of 1e5. The spring
    // starts with the path of a whole step, wherever in it the spheres meet, and the contact ends with its
    // shear force on, up to a step late. With x = pi sqrt(c q) each changes the impulse by up to q V h pi
    // sin(x) / x, which vanishes where both oscillators are in step, at q = 2/7 with free and q = 1 with
    // blocked rotation; there the error is of order h^2. The normal turns by 1e-7 V.
    for (const double q : {0.2, 2.0 / 7, 0.4, 1.0})
        for (const double v : {0.3, 2.0, 8.0}) {
            const ContactLaw law = sliding_law(0.5, q, 1e9);
            PairOptions o = pair();
            o.safety = 0.001;
            const Rebound out = collide(law, o, v);
            const double x = pi * std::sqrt(c() * q), h = out.step_angle, j = v * (1 - std::cos(x)) / c();
            const double first_order = 2 * q * h * pi * std::abs(std::sin(x)) / x,
                         second_order = 4 * c() * q * h * h;
            const double tolerance = v * (1e-6 + first_order + second_order);
            EXPECT_NEAR(out.tangential, j, tolerance) << q << " " << v;
            EXPECT_NEAR(out.sideways, 0, 1e-9) << q << " " << v;
            EXPECT_NEAR(out.normal, 1, 2e-5 + 1e-6 * v * v) << q << " " << v;
            EXPECT_NEAR(out.rotation, rotation_for(j), 2.5 * j * tolerance + 1e-6) << q << " " << v;
        }
}

TEST_P(ObliqueImpact, GrossSlidingTakesFrictionTimesTheNormalImpulse) {
    // Tolerance: h^2 / 8 of the impulse 2, which is 1.2e-5, and the turning of the normal.
    for (const double mu : {0.1, 0.5})
        for (const double q : {0.2, 0.4, 1.0}) {
            const double threshold = std::max(1 / q, 2 * c() - 1 / q);
            for (const double v : {1.02 * threshold, 3 * threshold}) {
                const Rebound out = collide(sliding_law(mu, q), pair(), mu * v);
                EXPECT_NEAR(out.tangential / mu, 2, 1.5e-5 + 2e-6 * v) << mu << " " << q << " " << v;
                EXPECT_NEAR(out.rotation / (mu * mu), rotation_for(2), 1e-4 + 1e-5 * v)
                    << mu << " " << q << " " << v;
            }
            // Below the threshold the contact sticks for a while and the impulse is another one.
            if (threshold > 1 / q) {
                EXPECT_LT(collide(sliding_law(mu, q), pair(), 0.9 * mu * threshold).tangential / mu,
                          2 - 1e-3);
            }
        }
}

TEST_P(ObliqueImpact, ReboundCurveFollowsSlipStickAndSlipAgain) {
    // From nearly normal to gross sliding. Tolerance h = 0.007: contacts that stick at first begin with the
    // path of a whole step, q V h <= h, and the switch between stick and slip is met to a step.
    for (const double q : {2.0 / 7, 0.4, 1.0})
        for (const double v : {0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 9.0}) {
            const double mu = 0.4, expected = integrated_rebound(v, q, c());
            const Rebound out = collide(sliding_law(mu, q), pair(), mu * v);
            EXPECT_NEAR(v - c() * out.tangential / mu, expected, out.step_angle) << q << " " << v;
        }
}

TEST_P(ObliqueImpact, SpinsOfUnequalSpheresCarryTheAngularMomentumOfTheirVelocities) {
    // Both feel the same tangential impulse J at their own radius: rotational energy is the sum of (J R)^2 /
    // (2 I).
    PairOptions o = pair();
    o.radius_1 = 0.02;
    const double mu = 0.3;
    const Rebound out = collide(sliding_law(mu, 0.4), o, 12 * mu);
    const double m = effective_mass(o.radius_0, o.radius_1, density), j = m * out.tangential;
    EXPECT_NEAR(out.tangential / mu, 2, 5e-5);
    double rotation = 0;
    if (turns())
        for (const double r : {o.radius_0, o.radius_1})
            rotation += j * j * r * r / (2 * 0.4 * sphere_mass(r, density) * r * r);
    EXPECT_NEAR(out.rotation, rotation / m, 2e-6);
}

INSTANTIATE_TEST_SUITE_P(Rotations, ObliqueImpact, testing::Combine(testing::Bool(), testing::Bool()),
                         [](const auto& info) {
                             return std::string(std::get<0>(info.param) ? "Free" : "Blocked") +
                                    (std::get<1>(info.param) ? "LinearDamped" : "LinearCohesive");
                         });

}  // namespace
}  // namespace loam::engine
