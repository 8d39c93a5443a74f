// Spheres that turn on each other: the end of sliding, and the effect rolling_resistance under every law.
//
// Spheres of two radii stand in a row that closes through the boundary, pressed together by F_n at every
// contact. They turn about an axis across the row; by symmetry their centres rest, and each has the moments
// of two contacts.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <vector>

#include "tests/verification/two_spheres.hpp"

namespace loam::engine {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using std::numbers::pi;

struct Chain {
    static constexpr double radius = 0.05, overlap = 1e-4;

    static Packing packing(double radius_1) {
        Packing out;
        const double spacing = radius + radius_1 - overlap;
        out.cell = Vector3d(4 * spacing, 1, 1).asDiagonal();
        out.centres.resize(3, 4);
        for (int k = 0; k < 4; ++k) out.centres.col(k) = Vector3d((k + 0.5) * spacing, 0.5, 0.5);
        out.radii = Eigen::Vector4d(radius, radius_1, radius, radius_1);
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
    Chain(const ContactLaw& law, const Vector3d& spin_0, const Vector3d& spin_1, double radius_1 = radius)
        : simulation(packing(radius_1), law, how()) {
        Matrix3Xd spins(3, 4);
        for (int k = 0; k < 4; ++k) spins.col(k) = k % 2 == 0 ? spin_0 : spin_1;
        simulation.set_spins(spins);
    }
    static double inertia(double r) { return 0.4 * sphere_mass(r, 2600) * r * r; }

    /// Steps until the time `t` since the start.
    void go_on_to(double t) {
        const double left = t / simulation.time_step() - static_cast<double>(simulation.steps());
        simulation.advance(std::max(1, static_cast<int>(std::lround(left))));
    }
    double normal_force() {
        simulation.advance(1);
        EXPECT_EQ(simulation.contacts().size(), 4u);
        return simulation.contacts().front().normal_force;
    }
    /// Of a sphere of each kind about the axis.
    std::array<double, 2> spins() const {
        const Matrix3Xd all = simulation.spins();
        return {all(2, 0), all(2, 1)};
    }

    Simulation simulation;
};

constexpr double friction = 0.5;

/// Every law, with friction, and without dashpots.
std::vector<ContactLaw> laws(double rolling_friction) {
    LinearCohesive linear = elastic_law(1e8);
    linear.friction_angle = std::atan(friction);
    LinearDamped damped;
    damped.normal_damping = damped.tangential_damping = 0;
    damped.friction_angle = std::atan(friction);
    HertzMindlin hertz;
    hertz.restitution = 1;
    hertz.friction_angle = std::atan(friction);
    std::vector<ContactLaw> out{linear, damped, hertz};
    for (ContactLaw& law : out) law.rolling.friction = rolling_friction;
    return out;
}

std::vector<ContactLaw> with_dashpots(std::vector<ContactLaw> all) {
    for (ContactLaw& law : all) {
        if (auto* damped = std::get_if<LinearDamped>(&law.base))
            damped->normal_damping = damped->tangential_damping = 0.2;
        if (auto* hertz = std::get_if<HertzMindlin>(&law.base)) hertz->restitution = 0.5;
    }
    return all;
}

TEST(Rolling, SlidingEndsWhereTheSurfacesMoveTogether) {
    // Friction slows both at the rate 2 mu F_n R / I until R (a + b) = 0: spins a, b become +-(a - b)/2, like
    // gears; a - b never changes. Without dashpots the shear springs then swing: the mean over many of their
    // periods is taken. Tolerance 0.2 % of the spins.
    for (const std::vector<ContactLaw>& all : {laws(0), with_dashpots(laws(0))})
        for (const ContactLaw& law : all) {
            Chain chain(law, Vector3d(0, 0, 400), Vector3d(0, 0, 100));
            const double moment = 2 * friction * chain.normal_force() * Chain::radius,
                         end = 250 * Chain::inertia(Chain::radius) / moment;
            chain.go_on_to(0.5 * end);
            EXPECT_NEAR(chain.spins()[0], 400 - 125, 0.5) << law.base.index();
            EXPECT_NEAR(chain.spins()[1], 100 - 125, 0.5) << law.base.index();
            chain.go_on_to(1.1 * end);
            double mean = 0;
            const int parts = 200;
            for (int k = 1; k <= parts; ++k) {
                chain.go_on_to((1.1 + 2.0 * k / parts) * end);
                mean += chain.spins()[0] / parts;
                EXPECT_NEAR(chain.spins()[0] - chain.spins()[1], 300, 1e-8);
            }
            EXPECT_NEAR(mean, 150, 0.5) << law.base.index();
        }
}

TEST(RollingResistance, StopsSpheresThatRollOnEachOther) {
    // No slip: R_0 w_0 + R_1 w_1 = 0. Moments of eta F_n min(R) = M on both, and a shear force f that keeps
    // them from slipping: I_0 w_0' = -2 (M + f R_0), I_1 w_1' = 2 (M - f R_1). Tolerance 2 % of the spin at
    // the start: the elastic beginning, and shear springs that swing on.
    const double eta = 0.02, r0 = Chain::radius;
    for (const double r1 : {0.05, 0.02})
        for (const std::vector<ContactLaw>& all : {laws(eta), with_dashpots(laws(eta))})
            for (const ContactLaw& law : all) {
                Chain chain(law, Vector3d(0, 0, 40), Vector3d(0, 0, -40 * r0 / r1), r1);
                const double m = eta * chain.normal_force() * std::min(r0, r1);
                const double i0 = Chain::inertia(r0), i1 = Chain::inertia(r1);
                const double f = m * (r1 / i1 - r0 / i0) / (r0 * r0 / i0 + r1 * r1 / i1);
                const double stop = 40 / (2 * (m + f * r0) / i0);
                for (const double part : {0.25, 0.5, 0.75}) {
                    chain.go_on_to(part * stop);
                    EXPECT_NEAR(chain.spins()[0], 40 * (1 - part), 0.1) << law.base.index() << " " << r1;
                    EXPECT_NEAR(chain.spins()[1] * r1 / r0, -40 * (1 - part), 0.8) << law.base.index();
                }
            }
}

TEST(RollingResistance, IsASpringBelowItsLimit) {
    // With the angles a and b of the spheres: shear springs of k_t (R_0 a + R_1 b) and rolling springs of
    // k_r (a - b), k_r = 2 k_t R_0 R_1, two of each a sphere: I_0 a'' = -2 (k_r (a - b) + k_t R_0 (R_0 a +
    // R_1 b)), and so for b, an oscillator of two modes; of equal spheres one, w² = 4 k_r / I. Tolerance 0.5
    // %: the lever arms are shorter than the radii by u/2.
    const double r0 = Chain::radius, nu = 0.3;
    for (const double r1 : {0.05, 0.02})
        for (const ContactLaw& law : laws(100)) {
            const Eigen::Vector2d start(1e-3, -5e-4);
            Chain chain(law, Vector3d(0, 0, start[0]), Vector3d(0, 0, start[1]), r1);
            const double modulus = law.young_modulus(), reduced = r0 * r1 / (r0 + r1);
            const std::array all{0.4 * 2 * modulus * reduced, 0.25 * pi * modulus * (r0 + r1) / 1.2,
                                 2 * modulus / ((1 + nu) * (2 - nu)) * std::sqrt(reduced * Chain::overlap)};
            const double kt = all[law.base.index()], kr = 2 * kt * r0 * r1;
            Eigen::Matrix2d stiffness;
            stiffness << kr + kt * r0 * r0, -kr + kt * r0 * r1, -kr + kt * r0 * r1, kr + kt * r1 * r1;
            const Eigen::Vector2d root(std::sqrt(Chain::inertia(r0)), std::sqrt(Chain::inertia(r1)));
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> modes(
                2 * root.cwiseInverse().asDiagonal() * stiffness * root.cwiseInverse().asDiagonal());
            const Eigen::Vector2d frequency = modes.eigenvalues().cwiseSqrt();
            const Eigen::Vector2d part = modes.eigenvectors().transpose() * root.asDiagonal() * start;
            for (const double angle : {0.5, 1.5, 3.0}) {
                const double t = angle / frequency[0];
                chain.go_on_to(t);
                const Eigen::Vector2d swings = (frequency * t).array().cos() * part.array();
                const Eigen::Vector2d spins =
                    root.cwiseInverse().asDiagonal() * modes.eigenvectors() * swings;
                EXPECT_NEAR(chain.spins()[0], spins[0], 1e-5) << law.base.index() << " " << r1;
                EXPECT_NEAR(chain.spins()[1], spins[1], 1e-5 * r0 / r1) << law.base.index() << " " << r1;
            }
        }
}

TEST(RollingResistance, TakesItsShareOfTheImpulseOfAnImpact) {
    // Opposite spins, far too fast for the springs of rolling: the moment is at its limit as long as the
    // force presses, so that each sphere loses eta min(R) J / I, J = m v (1 + e'') as for friction (see
    // test_oblique_further_laws.cpp). No slip: R_0 w_0 + R_1 w_1 = 0, which equal spheres keep.
    const double eta = 0.05;
    for (const bool dashpots : {false, true})
        for (const ContactLaw& law : dashpots ? with_dashpots(laws(eta)) : laws(eta)) {
            PairOptions o;
            o.free_rotation = true;
            o.safety = 0.002;
            o.gap = 1e-12;
            o.largest_overlap = 1e-4;
            TwoSpheres spheres(law, o);
            const double speed = 1e-3, start = 1000, r = o.radius_0;
            const Vector3d t = o.direction.cross(Vector3d::UnitY()).normalized();
            Matrix3Xd spins(3, 2);
            spins << start * t, -start * t;
            spheres.set_relative_velocity(-speed * o.direction);
            spheres.simulation.set_spins(spins);
            spheres.collide();
            const double m = effective_mass(r, r, 2600);
            double damping = 0;
            if (dashpots && law.base.index() == 1) damping = 0.2;
            if (dashpots && law.base.index() == 2) damping = std::log(2) / std::hypot(std::log(2), pi);
            const double root = std::sqrt(1 - damping * damping);
            const double angle = pi - std::atan2(2 * damping * root, 1 - 2 * damping * damping);
            const double impulse = m * speed * (1 + std::exp(-damping / root * angle));
            const double loss = start - spheres.simulation.spins().col(0).dot(t);
            EXPECT_NEAR(loss / (eta * r * impulse / Chain::inertia(r)), 1, 2e-3)
                << law.base.index() << dashpots;
        }
}

/// Two spheres of radius 0.05 m held at an overlap, and turned by hand: in a time so short that forces do
/// nothing.
class Turned {
  public:
    static constexpr double overlap = 1e-4;

    explicit Turned(const ContactLaw& law) : spheres_(law, options()) { spheres_.step(); }
    /// Turns the spheres by these angles (rad, about fixed axes) in `steps` steps.
    void turn(const Vector3d& by_0, const Vector3d& by_1, int steps) {
        Matrix3Xd spins(3, 2);
        spins << by_0, by_1;
        spheres_.simulation.set_spins(spins / (steps * spheres_.simulation.time_step()));
        spheres_.simulation.advance(steps);
        spheres_.simulation.set_spins(Matrix3Xd::Zero(3, 2));
        spheres_.step();
    }
    void set_overlap(double u) { spheres_.move_to((spheres_.radius_sum() - u) * normal()); }
    double energy() const { return spheres_.simulation.measured().elastic_energy; }
    static Vector3d normal() { return options().direction; }
    static Vector3d across() { return normal().cross(Vector3d::UnitY()).normalized(); }

  private:
    static PairOptions options() {
        PairOptions o;
        o.free_rotation = true;
        o.safety = 1e-9;
        o.gap = -overlap;
        o.largest_overlap = 0.01;
        return o;
    }
    TwoSpheres spheres_;
};

TEST(RollingResistance, ForceAndMomentTurnWithSpheresThatTwistTogether) {
    // Slip or rolling, half a turn of both about the normal, and the same slip or rolling again, about axes
    // that stand still: force and moment have come round to the other side, and nothing is left. The
    // tolerance is 1e-3 of what one of them stores; four times as much would be left without the turn. Only
    // the mean of the spins, each times its radius, counts: the last pair turns half a turn unequally.
    const Vector3d n = Turned::normal(), t = Turned::across();
    for (const ContactLaw& law : laws(100))
        for (const bool rolls : {false, true})
            for (const double share : {0.5, 0.8}) {
                Turned pair(law);
                const double normal = pair.energy();
                const Vector3d small = 1e-5 * t;
                pair.turn(rolls ? Vector3d(-small) : small, small, 100);
                const double stored = pair.energy() - normal;
                EXPECT_GT(stored, 1e-5 * normal);
                pair.turn(2 * share * pi * n, 2 * (1 - share) * pi * n, 5000);
                EXPECT_NEAR((pair.energy() - normal) / stored, 1, 5e-3) << law.base.index() << rolls;
                pair.turn(rolls ? Vector3d(-small) : small, small, 100);
                EXPECT_NEAR(pair.energy() - normal, 0, 1e-3 * stored) << law.base.index() << rolls << share;
            }
}

TEST(RollingResistance, HertzianMomentsShrinkWithTheirContactAndStayWhereItGrows) {
    // As shear forces do (Elata and Berryman): M²/(2 k_r) with k_r ~ sqrt(u) falls either way, to the square
    // root of the ratio of the overlaps. The normal energy 8/15 Y sqrt(R) u^(5/2) is taken off.
    for (const double overlap : {0.25 * Turned::overlap, 4 * Turned::overlap}) {
        const ContactLaw law = laws(100).back();
        const double y = law.young_modulus() / (2 * 0.91);
        const auto normal = [&](double u) { return 8.0 / 15 * y * std::sqrt(0.025) * std::pow(u, 2.5); };
        Turned pair(law);
        pair.turn(-1e-4 * Turned::across(), 1e-4 * Turned::across(), 100);
        const double stored = pair.energy() - normal(Turned::overlap);
        EXPECT_GT(stored, 1e-2 * normal(Turned::overlap));
        pair.set_overlap(overlap);
        EXPECT_NEAR((pair.energy() - normal(overlap)) / stored, 0.5, 1e-4) << overlap;
    }
}

TEST(RollingResistance, LetsSpheresTwist) {
    for (const ContactLaw& law : with_dashpots(laws(0.02))) {
        Chain chain(law, Vector3d(40, 0, 0), Vector3d(-40, 0, 0));
        chain.simulation.advance(2000);
        EXPECT_NEAR(chain.simulation.spins()(0, 0), 40, 1e-9) << law.base.index();
    }
}

TEST(RollingResistance, DoesNothingToSpheresThatTurnAlike) {
    // Equal spins slide, and do not roll: the rate is that of friction alone.
    for (const ContactLaw& law : laws(0.2)) {
        Chain chain(law, Vector3d(0, 0, 400), Vector3d(0, 0, 400));
        const double rate =
            2 * friction * chain.normal_force() * Chain::radius / Chain::inertia(Chain::radius);
        chain.go_on_to(200 / rate);
        EXPECT_NEAR(chain.spins()[0], 200, 0.5) << law.base.index();
    }
}

TEST(RollingResistance, OfStrengthZeroIsTheBaseLawBitForBit) {
    PackingOptions options;
    options.particles = 200;
    const Packing packing = make_packing(options).packing;
    for (const ContactLaw& law :
         {ContactLaw(LinearCohesive{}), ContactLaw(LinearDamped{}), ContactLaw(HertzMindlin{})}) {
        Eigen::Matrix3Xd centres[3], spins[3];
        Eigen::Matrix3d stress[3];
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
            const int k = strength < 0 ? 0 : strength > 0 ? 2 : 1;
            centres[k] = simulation.packing().centres;
            spins[k] = simulation.spins();
            stress[k] = simulation.measured().stress;
        }
        EXPECT_EQ(centres[1], centres[0]) << law.base.index();
        EXPECT_EQ(spins[1], spins[0]) << law.base.index();
        EXPECT_EQ(stress[1], stress[0]) << law.base.index();
        EXPECT_NE(centres[2], centres[0]) << law.base.index();  // and it does something
    }
}

TEST(RollingResistance, NeedsParticlesThatTurn) {
    ContactLaw law;
    law.rolling.friction = 0.1;
    SimulationOptions how;
    how.free_rotation = false;
    EXPECT_THROW(Simulation(Chain::packing(Chain::radius), law, how), std::invalid_argument);
}

}  // namespace
}  // namespace loam::engine
