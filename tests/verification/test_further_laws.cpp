// Head-on impacts under the laws linear-damped and hertz-mindlin, and the energy of their contacts.
//
// linear-damped: overlap of a damped oscillator, from contact to the end of the overlap (the dashpot may
// pull):
//   restitution exp(-pi D / sqrt(1 - D²)), duration pi / (w sqrt(1 - D²)), w² = k / m      (e.g. Schwager and
//   Poeschel 2007, eqs 4-8).
// hertz-mindlin without dashpots (Hertz 1882; Johnson 1985, section 11.4): largest overlap
//   (15 m v² / (16 Y sqrt R))^(2/5), peak force 4/3 Y sqrt(R) overlap^(3/2), duration 2 sqrt(pi) Gamma(7/5) /
//   Gamma(9/10) = 2.9433 overlap / v.
// hertz-mindlin with dashpots: the restitution is the parameter, at any speed (Antypov and Elliott 2011).
#include <gtest/gtest.h>

#include <array>

#include "tests/verification/two_spheres.hpp"

namespace loam::engine {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

struct Impact {
    double duration = 0, peak_force = 0, largest_overlap = 0, restitution = 0;
};

Impact collide(const ContactLaw& law, PairOptions o, double speed) {
    o.gap = 1e-9;
    TwoSpheres spheres(law, o);
    const double dt = spheres.simulation.time_step();
    spheres.set_relative_velocity(-speed * o.direction);
    Impact impact;
    double before = o.gap, entry = 0;
    for (int n = 1;; ++n) {
        const double force = spheres.step().norm(), now = spheres.gap();
        impact.peak_force = std::max(impact.peak_force, force);
        impact.largest_overlap = std::max(impact.largest_overlap, -now);
        const double crossing = (n - now / (now - before)) * dt;
        if (before > 0 && now <= 0) entry = crossing;
        if (before <= 0 && now > 0) {
            impact.duration = crossing - entry;
            impact.restitution = spheres.relative_velocity().dot(o.direction) / speed;
            return impact;
        }
        before = now;
    }
}

/// Radii and turning of an impact.
struct Pair {
    double radius_0, radius_1;
    bool free_rotation;
};
constexpr std::array pairs{Pair{0.05, 0.05, false}, Pair{0.05, 0.02, false}, Pair{0.05, 0.02, true}};

PairOptions options_of(const Pair& pair) {
    PairOptions o;
    o.radius_0 = pair.radius_0;
    o.radius_1 = pair.radius_1;
    o.free_rotation = pair.free_rotation;
    o.safety = 0.002;
    return o;
}

TEST(LinearDampedImpact, HasTheRestitutionAndDurationOfADampedOscillator) {
    // Tolerance: the dashpot sees the velocity of half a step before, an error of first order in w dt (7e-4
    // and less).
    for (const Pair& pair : pairs)
        for (const double share : {0.0, 0.05, 0.2, 0.6}) {
            LinearDamped law;
            law.young_modulus = 1e8;
            law.normal_damping = share;
            const double k = 0.25 * pi * 1e8 * (pair.radius_0 + pair.radius_1);
            const double w = std::sqrt(k / effective_mass(pair.radius_0, pair.radius_1, 2600));
            const double slow = std::sqrt(1 - share * share);
            const Impact impact = collide(law, options_of(pair), 0.3);
            EXPECT_NEAR(impact.restitution / std::exp(-pi * share / slow), 1, 1e-3) << share;
            EXPECT_NEAR(impact.duration * w * slow / pi, 1, 3e-4) << share;
        }
}

TEST(HertzImpact, HasTheOverlapForceAndDurationOfHertz) {
    const double hertz_duration = 2 * std::sqrt(pi) * std::tgamma(1.4) / std::tgamma(0.9);
    for (const Pair& pair : pairs)
        for (const double speed : {0.01, 0.3}) {
            HertzMindlin law;
            law.young_modulus = 1e9;
            law.restitution = 1;
            const double y = 1e9 / (2 * (1 - 0.3 * 0.3));
            const double r = pair.radius_0 * pair.radius_1 / (pair.radius_0 + pair.radius_1);
            const double m = effective_mass(pair.radius_0, pair.radius_1, 2600);
            const double overlap = std::pow(15 * m * speed * speed / (16 * y * std::sqrt(r)), 0.4);
            PairOptions o = options_of(pair);
            o.largest_overlap = overlap / (pair.radius_0 + pair.radius_1);
            const Impact impact = collide(law, o, speed);
            EXPECT_NEAR(impact.restitution, 1, 1e-6);
            EXPECT_NEAR(impact.largest_overlap / overlap, 1, 1e-5);
            EXPECT_NEAR(impact.peak_force / (4.0 / 3.0 * y * std::sqrt(r) * std::pow(overlap, 1.5)), 1, 1e-5);
            EXPECT_NEAR(impact.duration * speed / overlap, hertz_duration, 1e-5 * hertz_duration);
        }
}

TEST(HertzImpact, HasTheRestitutionThatItIsGivenAtAnySpeed) {
    for (const Pair& pair : pairs)
        for (const double restitution : {0.2, 0.5, 0.9})
            for (const double speed : {0.01, 0.3}) {
                HertzMindlin law;
                law.young_modulus = 1e9;
                law.restitution = restitution;
                PairOptions o = options_of(pair);
                o.largest_overlap = 1e-3;
                EXPECT_NEAR(collide(law, o, speed).restitution, restitution, 2e-4) << speed;
            }
}

TEST(FurtherLaws, ForceIsTheSlopeOfTheStoredEnergy) {
    // Central differences of second order over a hundredth of the overlap: 1e-4; read at rest, so that
    // dashpots are still.
    for (const ContactLaw& law : {ContactLaw(LinearDamped{}), ContactLaw(HertzMindlin{})}) {
        PairOptions o = options_of(pairs[1]);
        o.safety = 1e-9;
        o.largest_overlap = 0.01;
        TwoSpheres spheres(law, o);
        const double sum = spheres.radius_sum();
        for (const double overlap : {1e-3 * sum, 8e-3 * sum}) {
            const double h = 0.01 * overlap;
            const auto energy_at = [&](double u) {
                spheres.move_to((sum - u) * o.direction);
                return spheres.simulation.measured().elastic_energy;
            };
            const double slope = (energy_at(overlap + h) - energy_at(overlap - h)) / (2 * h);
            const double force = spheres.move_to((sum - overlap) * o.direction).norm();
            EXPECT_NEAR(slope / force, 1, 1e-4) << law.base.index();
        }
    }
}

/// Two spheres of Hertz and Mindlin that are moved by hand, and the work that this takes.
class Walk {
  public:
    explicit Walk(const HertzMindlin& law) : spheres_(law, options()) {}

    double sum() const { return spheres_.radius_sum(); }
    /// Along a straight line of overlap and path around the first sphere, in small steps (m).
    void go(double overlap, double path) {
        const double overlap_before = overlap_, path_before = path_;
        const int parts = started_ ? 100 : 1;
        for (int k = 1; k <= parts; ++k) {
            const double share = static_cast<double>(k) / parts;
            overlap_ = overlap_before + share * (overlap - overlap_before);
            path_ = path_before + share * (path - path_before);
            const Vector3d next =
                (sum() - overlap_) * (std::cos(path_ / sum()) * n_ + std::sin(path_ / sum()) * t_);
            const Vector3d force = -spheres_.move_to(next);  // on the second
            if (started_) work_ -= 0.5 * (force_ + force).dot(next - here_);
            here_ = next;
            force_ = force;
        }
        started_ = true;
    }
    double work() const { return work_; }
    /// What the engine has booked as lost, and as stored (J).
    double lost() const { return spheres_.simulation.energy().sliding; }
    double stored() const { return spheres_.simulation.measured().elastic_energy; }

  private:
    static PairOptions options() {
        PairOptions o = options_of(pairs[1]);
        o.safety = 1e-9;
        o.largest_overlap = 0.01;
        return o;
    }
    TwoSpheres spheres_;
    const Vector3d n_ = options().direction, t_ = n_.cross(Vector3d::UnitY()).normalized();
    double overlap_ = 0, path_ = 0, work_ = 0;
    bool started_ = false;
    Vector3d here_, force_;
};

TEST(FurtherLaws, NormalLoadUnderShearMakesNoEnergy) {
    // Elata and Berryman's cycles: shear by s at one overlap, change the overlap, shear back, return. A
    // spring k_t(u) times its displacement would give +-(k_2 - k_1) s²/2 a cycle, one way round. With a force
    // that stays while the contact grows, and shrinks with it, work of (k_2 - k_1) s²/2 goes in both ways
    // round, in every cycle. Tolerance 2e-3: the path of the spring is (R_0 + R_1)/d as long as that of the
    // centres. The engine's books know the spring's: 1e-6.
    HertzMindlin law;
    law.friction_angle = 1.5;
    law.restitution = 1;
    const double reduced = 0.05 * 0.02 / 0.07;
    const auto kt = [&](double u) { return 2 * law.young_modulus / (1.3 * 1.7) * std::sqrt(reduced * u); };
    for (const bool loads_under_shear : {true, false}) {
        Walk walk(law);
        const double low = 1e-4 * walk.sum(), high = 4e-4 * walk.sum(), s = 2e-5 * walk.sum();
        const double first = loads_under_shear ? low : high, second = loads_under_shear ? high : low;
        walk.go(first, 0);
        for (int cycle = 0; cycle < 3; ++cycle) {
            const double work = walk.work(), lost = walk.lost(), booked = lost + walk.stored();
            walk.go(first, s);
            walk.go(second, s);
            walk.go(second, 0);
            walk.go(first, 0);
            const double expected = 0.5 * (kt(high) - kt(low)) * s * s;
            EXPECT_NEAR((walk.work() - work) / expected, 1, 2e-3) << loads_under_shear << cycle;
            EXPECT_NEAR((walk.lost() + walk.stored() - booked) / expected, 1, 1e-6)
                << loads_under_shear << cycle;
            EXPECT_GT(walk.lost(), lost);
        }
    }
}

}  // namespace
}  // namespace loam::engine
