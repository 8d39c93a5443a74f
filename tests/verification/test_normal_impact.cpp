// Head-on impact of two spheres with the linear law.
//
// Undamped, the overlap is a half period of the oscillator m_eff, k: the contact lasts pi / w with w = sqrt(k
// / m_eff), its peak force is v sqrt(m_eff k), and the speed returns (e.g. Di Renzo & Di Maio 2004).
// Leap-frog turns the oscillator into one of its own kind, whose errors are known exactly. With h = w dt, and
// with the time of touching a fraction s before the first step in contact and s' after the last:
//   - (v_{n+1/2}^2 + w^2 x_n x_{n+1}) is conserved, so v'^2 / v^2 - 1 = h^2 (s'(1 - s') - s(1 - s)), within
//   h^2 / 4;
//   - the angle of a step is 2 asin(h/2), so the duration is shorter by h^2 / 24, to third order;
//   - the largest of the sampled forces is off by at most h^2 / 8.
//
// Cundall's damping multiplies each component of a force by 1 + alpha where it opposes the velocity and by 1
// - alpha where it follows it (Smilauer et al. 2015, YADE manual, "Numerical damping"). In a head-on impact
// without total momentum force and velocity are collinear, so the spring has stiffness (1 + alpha) k on the
// way in and (1 - alpha) k on the way out, whatever the direction. From (1 + alpha) k d^2 = m v^2 and m v'^2
// = (1 - alpha) k d^2:
//   restitution sqrt((1 - alpha) / (1 + alpha)), duration (pi / 2w) (1/sqrt(1 + alpha) + 1/sqrt(1 - alpha)),
//   peak force v sqrt(m_eff k / (1 + alpha)).
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/verification/two_spheres.hpp"

namespace loam::engine {
namespace {

using Eigen::Vector3d;

constexpr double modulus = 1e8, density = 2600, pi = std::numbers::pi;

struct Impact {
    double duration = 0, peak_force = 0, speed_ratio = 0;
    double step_angle = 0;  // w dt
};

/// The times of touching and parting are those at which straight paths cross; outside of the contact they are
/// straight.
Impact collide(PairOptions o, double speed) {
    const double w = std::sqrt(series_stiffness(modulus, o.radius_0, o.radius_1) /
                               effective_mass(o.radius_0, o.radius_1, density));
    TwoSpheres pair(elastic_law(modulus), o);
    const double dt = pair.simulation.time_step();
    o.gap = 1.37 * speed * dt;  // touches within a step
    TwoSpheres spheres(elastic_law(modulus), o);
    spheres.set_relative_velocity(-speed * o.direction);
    Impact impact;
    double before = o.gap, entry = 0;
    for (int n = 1;; ++n) {
        impact.peak_force = std::max(impact.peak_force, spheres.step().norm());
        const double now = spheres.gap(), crossing = (n - now / (now - before)) * dt;
        if (before > 0 && now <= 0) entry = crossing;
        if (before <= 0 && now > 0) {
            impact.duration = crossing - entry;
            break;
        }
        before = now;
    }
    spheres.simulation.advance(1);  // the step that feels no force any more
    impact.speed_ratio = spheres.relative_velocity().dot(o.direction) / speed;
    impact.step_angle = w * dt;
    return impact;
}

/// Overlaps of some 1e-3 R: the linear law has no limit on them, and rounding stays far below the errors of
/// the step.
double speed_for(double radius) {
    return 1e-3 * radius * std::sqrt(3 * modulus / (2 * pi * radius * radius * density));
}

struct Pair {
    double radius_0, radius_1;
};
class NormalImpact : public testing::TestWithParam<Pair> {};

TEST_P(NormalImpact, DurationPeakForceAndSpeedFollowTheHalfPeriodToSecondOrder) {
    PairOptions o;
    o.radius_0 = GetParam().radius_0;
    o.radius_1 = GetParam().radius_1;
    const double v = speed_for(std::min(o.radius_0, o.radius_1));
    const double k = series_stiffness(modulus, o.radius_0, o.radius_1),
                 m = effective_mass(o.radius_0, o.radius_1, density);
    for (o.safety = 0.4; o.safety > 0.005; o.safety /= 2) {
        const Impact impact = collide(o, v);
        const double h = impact.step_angle, h2 = h * h;
        EXPECT_LE(std::abs(impact.speed_ratio * impact.speed_ratio - 1), 0.25 * h2 * (1 + h2) + 1e-11)
            << o.safety;
        EXPECT_LE(std::abs(impact.peak_force / (v * std::sqrt(m * k)) - 1), 0.125 * h2 * (1 + h2) + 1e-11)
            << o.safety;
        // Both ends err by less than 0.016 h^3 (linear for a sinusoidal crossing), over pi.
        EXPECT_NEAR(impact.duration * std::sqrt(k / m) / pi, 1 - h2 / 24, 0.011 * h * h2 + h2 * h2 + 1e-11)
            << o.safety;
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, NormalImpact,
                         testing::Values(Pair{0.05, 0.05}, Pair{0.05, 0.02}, Pair{0.01, 0.06}),
                         [](const auto& info) { return std::to_string(info.index); });

class DampedImpact : public testing::TestWithParam<double> {};

TEST_P(DampedImpact, RestitutionIsThatOfTwoQuarterPeriods) {
    // Tolerance: at the turning point one step may be counted to the wrong side, an energy of order h^2; the
    // samples of the ends err as above. 0.5 h^2 / (1 - alpha) holds both. The turning itself comes up to half
    // a step late, which the slower way out stretches: 0.6 h / (1 - alpha) for the duration.
    const double alpha = GetParam(), v = speed_for(0.05);
    const double k = series_stiffness(modulus, 0.05, 0.05), m = effective_mass(0.05, 0.05, density);
    for (const Vector3d& direction :
         {Vector3d(1, 0, 0), Vector3d(0, -0.6, 0.8), Vector3d(2.0 / 3, -1.0 / 3, 2.0 / 3)})
        for (const double safety : {0.1, 0.02}) {
            PairOptions o;
            o.damping = alpha;
            o.direction = direction;
            o.safety = safety;
            const Impact impact = collide(o, v);
            const double h = impact.step_angle, tolerance = 0.5 * h * h / (1 - alpha);
            EXPECT_NEAR(impact.speed_ratio, std::sqrt((1 - alpha) / (1 + alpha)), tolerance);
            EXPECT_NEAR(impact.peak_force / (v * std::sqrt(m * k)), 1 / std::sqrt(1 + alpha), tolerance);
            EXPECT_NEAR(impact.duration * 2 * std::sqrt(k / m) / pi,
                        1 / std::sqrt(1 + alpha) + 1 / std::sqrt(1 - alpha), 0.6 * h / (1 - alpha));
        }
}

INSTANTIATE_TEST_SUITE_P(Alphas, DampedImpact, testing::Values(0.1, 0.4, 0.8),
                         [](const auto& info) { return std::to_string(info.index); });

}  // namespace
}  // namespace loam::engine
