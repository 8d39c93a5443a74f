// Energy and momentum of packings.
//
// Work done by the cell = change of elastic and kinetic energy + loss by sliding + loss by damping. Books
// below takes the terms at one instant: the work from the stress by the trapezoidal rule, the kinetic energy
// as the mean of half a step before and after (leap-frog), so that the balance of an undamped run errs by
// dt^2. The engine's own balance differs in the kinetic energy, by half a step.
//
// The packing is a lattice with disorder of the size e, whose contacts open, close and slide at strains of
// that size; with linear springs nothing but the effects of finite turning depends on e. One remains as dt
// goes to nought: the spring of the shear force is stretched by (R_i + R_j)/d times the displacement of the
// contact, against ratcheting, which makes elastic energy of e times the shear part of the work out of
// nothing or loses it.
//
// Tolerances, of the work (of its absolute value, summed): 1e-6 at e = 1e-6; 1e-7 without friction, where
// rounding (1e-16 / e each step) is smaller at e = 1e-5; 0.5 e with friction.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "engine/simulation.hpp"
#include "tests/verification/lattice.hpp"

namespace loam::engine {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double modulus = 1e8;

LinearCohesive law_with(double friction_angle, double cohesion) {
    LinearCohesive law;
    law.young_modulus = modulus;
    law.friction_angle = friction_angle;
    law.normal_cohesion = law.shear_cohesion = cohesion;
    return law;
}

/// Compression of the axes by unlike amounts, and shear.
Matrix3d loading() {
    Matrix3d gradient;
    gradient << -0.3, 0.4, 0, 0, 0.5, 0, -0.6, 0, -1;
    return gradient;
}

/// The balance of a run, from what is measured at every step.
struct Books {
    double work = 0, effort = 0;      // effort: sum of the work's absolute values
    double sliding = 0, damping = 0;  // lost
    double smallest_loss = 0;         // in a step, of either kind
    double change = 0;                // of elastic and kinetic energy
    double engine_error = 0;          // of the engine's own balance, over the effort
    double changes = 0;               // contacts that opened or closed, at least
    double broken_bond_ratio = 0;
    double error() const { return std::abs(work - sliding - damping - change) / effort; }
};

Books keep_books(const ContactLaw& law, bool free_rotation, double disorder, double safety, double duration,
                 double damping = 0, bool density_scaling = false) {
    SimulationOptions how;
    how.free_rotation = free_rotation;
    how.density_scaling = density_scaling;
    how.damping = damping;
    how.time_step_safety = safety;
    how.energy_balance = true;
    how.largest_overlap = 10 * disorder;  // of Hertzian contacts: a constant time step
    Simulation simulation(disturbed_lattice(3, disorder, 7), law, how);
    if (law.cementation.strength > 0) {
        simulation.advance(1);
        simulation.cement_contacts();
    }
    // The path lasts `duration` times the p-wave's time across a particle, whatever the time step.
    const int steps = static_cast<int>(std::lround(duration / safety));
    const Matrix3d gradient = 3 * disorder / (steps * simulation.time_step()) * loading();
    simulation.set_velocity_gradient(gradient);
    Books books;
    double stored_start = 0, kinetic_before = 0, contacts_before = 0, power_before = 0;
    EnergyBalance before;
    for (int n = 0; n <= steps; ++n) {
        const double volume = simulation.volume();  // as the step begins, where its forces are
        const Measurement& now = simulation.advance(1);
        const double power = -volume * now.stress.cwiseProduct(gradient).sum();
        const double stored = now.elastic_energy + 0.5 * (now.kinetic_energy + kinetic_before);
        if (n == 0) {
            stored_start = stored;
        } else {
            const double work = 0.5 * simulation.time_step() * (power + power_before);
            const double loss = simulation.energy().sliding - before.sliding,
                         damped = simulation.energy().damping - before.damping;
            books.work += work;
            books.effort += std::abs(work);
            books.sliding += loss;
            books.damping += damped;
            books.smallest_loss = std::min({books.smallest_loss, loss, damped});
            books.changes += std::abs(now.contacts - contacts_before);
        }
        books.change = stored - stored_start;
        power_before = power;
        kinetic_before = now.kinetic_energy;
        contacts_before = now.contacts;
        before = simulation.energy();
    }
    books.broken_bond_ratio = simulation.measured().broken_bond_ratio;
    const EnergyBalance& e = simulation.energy();
    books.engine_error =
        std::abs(e.work - e.sliding - e.damping - (e.stored - e.stored_start)) / books.effort;
    return books;
}

class Balance : public testing::TestWithParam<bool> {};

TEST_P(Balance, ClosesWithoutFriction) {
    for (const auto& [disorder, tolerance] : {std::pair{1e-6, 1e-6}, std::pair{1e-5, 1e-7}}) {
        const Books books = keep_books(law_with(0, 0), GetParam(), disorder, 0.005, 40);
        EXPECT_GT(books.changes, 50);
        EXPECT_LT(books.error(), tolerance);
        // A contact that opens loses the square of its last gap: nothing at this time step.
        EXPECT_LT(books.sliding, tolerance * books.effort);
        EXPECT_GE(books.smallest_loss, 0);
    }
}

TEST_P(Balance, ClosesWithSlidingFriction) {
    for (const auto& [disorder, tolerance] :
         {std::pair{1e-6, 1e-6}, std::pair{1e-5, 5e-6}, std::pair{1e-4, 5e-5}}) {
        const Books books = keep_books(law_with(0.31, 0), GetParam(), disorder, 0.005, 40);
        EXPECT_GT(books.sliding, 0.05 * books.effort);
        EXPECT_LT(books.error(), tolerance);
        EXPECT_GE(books.smallest_loss, 0);
    }
}

TEST_P(Balance, ClosesWithSlowedSpins) {
    // Moments of inertia 1.8 times those of spheres: what shear springs as stiff as the normal ones ask for.
    LinearCohesive law = law_with(0.31, 0);
    law.stiffness_ratio = 1;
    const Books books = keep_books(law, GetParam(), 1e-6, 0.005, 40, 0, true);
    EXPECT_GT(books.sliding, 0.03 * books.effort);
    EXPECT_LT(books.error(), 1e-6);
    EXPECT_GE(books.smallest_loss, 0);
}

TEST_P(Balance, ErrorFallsWithTheSquareOfTheTimeStep) {
    // Four times smaller steps: 16 times smaller error; a quarter is left to events that fall between steps.
    for (const double friction_angle : {0.0, 0.31}) {
        const double coarse = keep_books(law_with(friction_angle, 0), GetParam(), 1e-6, 0.16, 40).error();
        const double fine = keep_books(law_with(friction_angle, 0), GetParam(), 1e-6, 0.04, 40).error();
        EXPECT_LT(coarse, 5e-5);
        EXPECT_LT(fine, coarse / 12);
    }
}

TEST_P(Balance, TheEnginesOwnBookkeepingClosesToo) {
    // It adds half a step of kinetic energy to the error of the run itself.
    for (const auto& [safety, tolerance] :
         {std::pair{0.6, 2e-3}, std::pair{0.3, 6e-4}, std::pair{0.02, 1e-5}}) {
        const Books books = keep_books(law_with(0.31, 0), GetParam(), 1e-5, safety, 400);
        EXPECT_LT(books.engine_error, tolerance) << safety;
    }
}

TEST_P(Balance, LossesWithBreakingBondsAreNeverNegative) {
    // A bond that breaks gives its energy away within one step, known to v dt: an error of first order.
    const Books books = keep_books(law_with(0.31, 50), GetParam(), 1e-6, 0.01, 200);
    EXPECT_GT(books.sliding, 0.05 * books.effort);
    EXPECT_GE(books.smallest_loss, 0);
    EXPECT_LT(books.error(), 1e-5);
    // At the usual time step a limit may fall, and the force cross it to the other side, all within one step:
    // its mean force then goes against the slip. What that gives back must stay out of sight.
    const Books coarse = keep_books(law_with(0.31, 50), GetParam(), 1e-6, 0.7, 2000);
    EXPECT_GE(coarse.smallest_loss, -1e-6 * coarse.sliding);
}

/// The other laws, with dashpots or without, and with rolling resistance where particles turn.
std::vector<ContactLaw> other_laws(bool free_rotation, bool dashpots) {
    LinearDamped damped;
    damped.young_modulus = modulus;
    damped.friction_angle = 0.31;
    damped.normal_damping = damped.tangential_damping = dashpots ? 0.2 : 0.0;
    HertzMindlin hertz;
    hertz.young_modulus = modulus;
    hertz.friction_angle = 0.31;
    hertz.restitution = dashpots ? 0.5 : 1.0;
    std::vector<ContactLaw> laws{damped, hertz};
    if (!free_rotation) return laws;
    for (const ContactLaw& base : {ContactLaw(law_with(0.31, 0)), ContactLaw(damped), ContactLaw(hertz)}) {
        laws.push_back(base);
        laws.back().rolling.friction = 0.05;
    }
    return laws;
}

TEST_P(Balance, ClosesForEveryLawWithoutDashpots) {
    for (const ContactLaw& law : other_laws(GetParam(), false)) {
        const Books books = keep_books(law, GetParam(), 1e-6, 0.005, 40);
        EXPECT_GT(books.sliding, 0.02 * books.effort) << law.base.index();
        EXPECT_LT(books.error(), 1e-6) << law.base.index();
        EXPECT_GE(books.smallest_loss, -1e-9 * books.sliding) << law.base.index();
        const double coarse = keep_books(law, GetParam(), 1e-6, 0.16, 40).error();
        const double fine = keep_books(law, GetParam(), 1e-6, 0.04, 40).error();
        // Of second order, but for the shear stiffness of Hertzian contacts, which a step has of its end.
        EXPECT_LT(fine, coarse / 4) << law.base.index();
    }
}

TEST_P(Balance, DashpotsTakeEnergyAndNeverGive) {
    // Their power is known to half a step: an error of first order.
    for (const ContactLaw& law : other_laws(GetParam(), true))
        for (const auto& [safety, tolerance] : {std::pair{0.07, 5e-6}, std::pair{0.01, 3e-5}}) {
            const Books books = keep_books(law, GetParam(), 1e-6, safety, safety > 0.05 ? 400 : 40);
            EXPECT_GT(books.sliding, 0.05 * books.effort) << law.base.index();
            EXPECT_LT(books.error(), tolerance) << law.base.index() << " " << safety;
            EXPECT_GE(books.smallest_loss, -1e-9 * books.sliding) << law.base.index();
        }
}

TEST_P(Balance, DashpotsAreStableAtTheUsualTimeStep) {
    // Twelve contacts a sphere, all with a dashpot; an unstable step would take in energy out of nothing,
    // which the books show at once. Weak and strong dashpots: their shares count unlike in a step.
    for (ContactLaw law : other_laws(GetParam(), true))
        for (const double share : {0.1, 0.2, 0.5, 1.0}) {
            if (auto* damped = std::get_if<LinearDamped>(&law.base))
                damped->normal_damping = damped->tangential_damping = share;
            if (auto* hertz = std::get_if<HertzMindlin>(&law.base)) hertz->restitution = 1 - share;
            const Books books = keep_books(law, GetParam(), 1e-6, 0.7, 2000);
            EXPECT_LT(books.error(), 1e-3) << law.base.index() << " " << law.rolling.friction << " " << share;
            EXPECT_GE(books.smallest_loss, -1e-6 * books.sliding) << law.base.index();
        }
}

TEST_P(Balance, LocalDampingTakesEnergyInEveryStep) {
    // At a tenth of the usual time step and at that itself.
    std::vector<ContactLaw> laws = other_laws(GetParam(), true);
    laws.push_back(law_with(0.31, 0));
    for (const ContactLaw& law : laws)
        for (const auto& [safety, tolerance] : {std::pair{0.07, 2e-4}, std::pair{0.7, 2e-3}}) {
            const Books books = keep_books(law, GetParam(), 1e-6, safety, 40, 0.4);
            EXPECT_GT(books.damping, 1e-4 * books.effort) << law.base.index();
            EXPECT_GE(books.smallest_loss, -1e-9 * books.damping) << law.base.index() << " " << safety;
            EXPECT_LT(books.error(), tolerance) << law.base.index() << " " << safety;
        }
}

/// Every effect alone and all together, on every law that it goes with, without dashpots; of a strength that
/// the stresses of a lattice with this disorder meet.
std::vector<ContactLaw> laws_with_effects(bool free_rotation, double disorder) {
    const double stress = 50 * disorder / 1e-6;
    std::vector<ContactLaw> laws;
    for (ContactLaw base : other_laws(false, false)) {
        for (const ContactLaw& law : {base, ContactLaw(law_with(0.31, 0))}) {
            if (law.base.index() == 0 && base.base.index() != 1) continue;
            const bool hertz = std::holds_alternative<HertzMindlin>(law.base);
            const double scale = hertz ? stress * std::sqrt(disorder) : stress;
            std::array<ContactLaw, 6> with;
            with.fill(law);
            with[0].adhesion.stress = with[5].adhesion.stress = scale;
            with[1].capillarity = with[5].capillarity = {.suction = 2 * scale, .filling_angle = 0.05};
            with[2].cementation.strength = with[5].cementation.strength = scale;
            with[3].plastic.share = with[5].plastic.share = 0.3;
            if (!hertz) with[4].hertzian = with[5].hertzian = {.share = 0.7, .reference_pressure = stress};
            if (free_rotation) with[5].rolling.friction = 0.05;
            for (const ContactLaw& one : with) laws.push_back(one);
        }
    }
    return laws;
}

TEST_P(Balance, ClosesWithEveryEffect) {
    // A bond that breaks is known to v dt, as above: an error of first order.
    for (const ContactLaw& law : laws_with_effects(GetParam(), 1e-6)) {
        const Books books = keep_books(law, GetParam(), 1e-6, 0.01, 40);
        EXPECT_GT(books.sliding, 0.02 * books.effort) << law.base.index();
        EXPECT_LT(books.error(), 1e-5) << law.base.index();
        EXPECT_GE(books.smallest_loss, -1e-9 * books.sliding) << law.base.index();
        EXPECT_EQ(books.broken_bond_ratio > 0, law.cementation.strength > 0) << law.base.index();
        EXPECT_LT(books.broken_bond_ratio, 1);
    }
}

TEST_P(Balance, ClosesWhereLiquidBridgesRupture) {
    // At strains of 6 %, without friction, so that ruptures alone lose energy; each is known to v dt, and the
    // balance to 3 % of what they lose.
    for (const ContactLaw& base : {ContactLaw(law_with(0, 0)), other_laws(false, false)[1]}) {
        ContactLaw law = base;
        std::visit([](auto& one) { one.friction_angle = 0; }, law.base);
        law.capillarity = {.suction = 3e7, .filling_angle = 0.05};
        const Books books = keep_books(law, GetParam(), 0.02, 0.01, 100);
        EXPECT_GT(books.sliding, 1e-4 * books.effort) << law.base.index();
        EXPECT_LT(books.error() * books.effort, 0.03 * books.sliding) << law.base.index();
        EXPECT_GE(books.smallest_loss, 0) << law.base.index();
    }
}

TEST_P(Balance, MomentumStaysToRounding) {
    // Blocked and free, at rest and with momentum to begin with, in a cell that deforms: pair forces are
    // opposite, and the velocities are relative to the mean field. Tolerance: 1e-12 of the sum of m |v|,
    // after 20,000 steps.
    PackingOptions options;
    options.particles = 150;
    options.target_porosity = 0.44;
    const Packing packing = make_packing(options).packing;
    const Eigen::VectorXd mass = packing.radii.array().cube();
    std::vector<std::pair<Vector3d, ContactLaw>> cases{{Vector3d(0, 0, 0), ContactLaw{}},
                                                       {Vector3d(0.02, -0.01, 0.03), ContactLaw{}}};
    for (const ContactLaw& law : other_laws(GetParam(), true))
        cases.push_back({Vector3d(0.02, -0.01, 0.03), law});
    for (const auto& [drift, law] : cases) {
        SimulationOptions how;
        how.free_rotation = GetParam();
        how.damping = 0;
        Simulation simulation(packing, law, how);
        std::mt19937_64 random(3);
        Matrix3Xd v(3, packing.radii.size());
        for (double& x : v.reshaped()) x = 0.02 * (static_cast<double>(random() >> 11) * 0x1.0p-53 - 0.5);
        v.colwise() -= v * mass / mass.sum();
        v.colwise() += drift;
        simulation.set_velocities(v);
        Matrix3d gradient = Matrix3d::Zero();
        gradient(2, 2) = -1e-6 / simulation.time_step();
        gradient(0, 2) = 5e-7 / simulation.time_step();
        simulation.set_velocity_gradient(gradient);
        for (int k = 0; k < 4; ++k) {
            simulation.advance(5000);
            const Matrix3Xd now = simulation.velocities();
            EXPECT_LT((now * mass - drift * mass.sum()).norm(), 1e-12 * (now.colwise().norm() * mass).value())
                << k;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Rotations, Balance, testing::Bool(),
                         [](const auto& info) { return info.param ? "Free" : "Blocked"; });

}  // namespace
}  // namespace loam::engine
