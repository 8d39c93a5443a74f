// Head-on impacts and rolling under the laws linear-damped and hertz-mindlin and the effect
// rolling_resistance.
//
// linear-damped: overlap of a damped oscillator, from contact to the end of the overlap (the dashpot may
// pull):
//   restitution exp(-pi D / sqrt(1 - D²)), duration pi / (w sqrt(1 - D²)), w² = k / m      (e.g. Schwager and
//   Poeschel 2007, eqs 4-8).
// hertz-mindlin without dashpots (Hertz 1882; Johnson 1985, section 11.4): largest overlap
//   (15 m v² / (16 Y sqrt R))^(2/5), peak force 4/3 Y sqrt(R) overlap^(3/2), duration 2.9432 overlap / v.
// hertz-mindlin with dashpots: the restitution is the parameter, at any speed (Antypov and Elliott 2011).
#include <gtest/gtest.h>

#include <array>

#include "tests/verification/two_spheres.hpp"

namespace loam::engine {
namespace {

using Eigen::Matrix3Xd;
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
    // Tolerance: the dashpot sees the velocity of half a step before, an error of first order in w dt (2e-3).
    for (const Pair& pair : pairs)
        for (const double share : {0.0, 0.05, 0.2, 0.6}) {
            LinearDamped law;
            law.young_modulus = 1e8;
            law.normal_damping = share;
            const double k = 0.25 * pi * 1e8 * (pair.radius_0 + pair.radius_1);
            const double w = std::sqrt(k / effective_mass(pair.radius_0, pair.radius_1, 2600));
            const double slow = std::sqrt(1 - share * share);
            const Impact impact = collide(law, options_of(pair), 0.3);
            EXPECT_NEAR(impact.restitution / std::exp(-pi * share / slow), 1, 5e-3) << share;
            EXPECT_NEAR(impact.duration * w * slow / pi, 1, 2e-3) << share;
        }
}

TEST(HertzImpact, HasTheOverlapForceAndDurationOfHertz) {
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
            EXPECT_NEAR(impact.restitution, 1, 1e-5);
            EXPECT_NEAR(impact.largest_overlap / overlap, 1, 1e-5);
            EXPECT_NEAR(impact.peak_force / (4.0 / 3.0 * y * std::sqrt(r) * std::pow(overlap, 1.5)), 1, 1e-5);
            EXPECT_NEAR(impact.duration * speed / overlap, 2.9432, 1e-3);
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
                EXPECT_NEAR(collide(law, o, speed).restitution, restitution, 3e-3) << speed;
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

/// Four equal spheres in a row that closes through the boundary, pressed together for good.
struct Chain {
    static constexpr double radius = 0.05, overlap = 1e-4;

    static Packing packing() {
        Packing out;
        const double spacing = 2 * radius - overlap;
        out.cell = Vector3d(4 * spacing, 1, 1).asDiagonal();
        out.centres.resize(3, 4);
        for (int k = 0; k < 4; ++k) out.centres.col(k) = Vector3d((k + 0.5) * spacing, 0.5, 0.5);
        out.radii = Eigen::VectorXd::Constant(4, radius);
        return out;
    }
    static SimulationOptions how() {
        SimulationOptions options;
        options.free_rotation = true;
        options.damping = 0;
        options.time_step_safety = 0.01;
        options.largest_overlap = 0.01;
        return options;
    }
    /// Neighbours turn against each other, about an axis across the chain or along it.
    Chain(const ContactLaw& law, const Vector3d& spin) : simulation(packing(), law, how()) {
        Matrix3Xd spins(3, 4);
        for (int k = 0; k < 4; ++k) spins.col(k) = k % 2 == 0 ? spin : Vector3d(-spin);
        simulation.set_spins(spins);
    }
    static double inertia() { return 0.4 * sphere_mass(radius, 2600) * radius * radius; }

    Simulation simulation;
};

std::vector<ContactLaw> rolling_laws(double friction) {
    LinearDamped damped;
    damped.normal_damping = damped.tangential_damping = 0;
    HertzMindlin hertz;
    hertz.restitution = 1;
    std::vector<ContactLaw> laws{elastic_law(1e8), damped, hertz};
    for (ContactLaw& law : laws) law.rolling.friction = friction;
    return laws;
}

TEST(RollingResistance, StopsSpheresThatRollOnEachOther) {
    // Equal and opposite spins: no slip at the contacts. At the limit the moment on each is 2 eta F_n R, of
    // both contacts, so the spin falls in proportion to time. Tolerance 1 % of the spin at the start: the
    // elastic beginning.
    for (const ContactLaw& law : rolling_laws(0.02)) {
        Chain chain(law, Vector3d(0, 0, 40));
        chain.simulation.advance(1);
        const double force = chain.simulation.contacts().front().normal_force;
        ASSERT_EQ(chain.simulation.contacts().size(), 4u);
        const double slope = 2 * 0.02 * force * Chain::radius / Chain::inertia(), stop = 40 / slope;
        const double dt = chain.simulation.time_step();
        for (const double part : {0.25, 0.5, 0.75}) {
            const double done = static_cast<double>(chain.simulation.steps());
            chain.simulation.advance(static_cast<int>(part * stop / dt - done));
            const Matrix3Xd spins = chain.simulation.spins();
            EXPECT_NEAR(spins(2, 0), 40 * (1 - part), 0.4) << law.base.index();
            EXPECT_NEAR(spins(2, 0) + spins(2, 1), 0, 1e-9);
        }
    }
}

TEST(RollingResistance, IsASpringBelowItsLimit) {
    // I dw/dt = -2 k_r (angle between the spheres), k_r = 2 k_t R²: the spin is zero after a quarter period.
    for (const ContactLaw& law : rolling_laws(100)) {
        Chain chain(law, Vector3d(0, 1e-3, 0));
        const double modulus = law.young_modulus(), nu = 0.3;
        const std::array kt{
            0.4 * modulus * Chain::radius, 0.5 * pi * modulus * Chain::radius / 1.2,
            2 * modulus / ((1 + nu) * (2 - nu)) * std::sqrt(0.5 * Chain::radius * Chain::overlap)};
        const double kr = 2 * kt[law.base.index()] * Chain::radius * Chain::radius;
        const double quarter = 0.5 * pi / std::sqrt(4 * kr / Chain::inertia());
        const int steps = static_cast<int>(std::lround(quarter / chain.simulation.time_step()));
        chain.simulation.advance(steps);
        EXPECT_NEAR(chain.simulation.spins()(1, 0), 0, 1e-3 * 0.01) << law.base.index();
        chain.simulation.advance(steps);
        EXPECT_NEAR(chain.simulation.spins()(1, 0), -1e-3, 1e-3 * 0.01) << law.base.index();
    }
}

TEST(RollingResistance, LetsSpheresTwist) {
    for (const ContactLaw& law : rolling_laws(0.02)) {
        Chain chain(law, Vector3d(40, 0, 0));
        chain.simulation.advance(2000);
        EXPECT_NEAR(chain.simulation.spins()(0, 0), 40, 1e-9) << law.base.index();
    }
}

TEST(RollingResistance, OfStrengthZeroIsTheBaseLawBitForBit) {
    PackingOptions options;
    options.particles = 200;
    const Packing packing = make_packing(options).packing;
    for (ContactLaw law :
         {ContactLaw(LinearCohesive{}), ContactLaw(LinearDamped{}), ContactLaw(HertzMindlin{})}) {
        Eigen::Matrix3Xd centres[3];
        for (const double strength : {-1.0, 0.0, 0.1}) {
            ContactLaw one = law;
            if (strength >= 0) one.rolling = {.friction = strength, .stiffness = 3};
            SimulationOptions how;
            how.free_rotation = true;
            how.time_step_safety = 0.3;
            Simulation simulation(packing, one, how);
            Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
            gradient(2, 2) = -1e-5 / simulation.time_step();
            simulation.set_velocity_gradient(gradient);
            simulation.advance(500);
            centres[strength < 0 ? 0 : strength > 0 ? 2 : 1] = simulation.packing().centres;
        }
        EXPECT_EQ(centres[1], centres[0]) << law.base.index();
        EXPECT_NE(centres[2], centres[0]) << law.base.index();  // and it does something
    }
}

TEST(RollingResistance, NeedsParticlesThatTurn) {
    ContactLaw law;
    law.rolling.friction = 0.1;
    SimulationOptions how;
    how.free_rotation = false;
    EXPECT_THROW(Simulation(Chain::packing(), law, how), std::invalid_argument);
}

}  // namespace
}  // namespace loam::engine
