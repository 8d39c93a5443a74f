// The laws as functions of plain numbers, without a simulation. For each: its formulas with numbers put in
// here; force = -dU/d(gap) and k_n = dF/du by central differences; and for Hertz-Mindlin contacts that a
// change of the shear stiffness never makes energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/contact/composition.hpp"

namespace loam::engine {
namespace {

// What the laws need of a T that is one double.
double choose(bool mask, double a, double b) {
    return mask ? a : b;
}
double square_root(double a) {
    return std::sqrt(a);
}

}  // namespace
}  // namespace loam::engine

#include "engine/contact/hertz_mindlin.hpp"
#include "engine/contact/linear_cohesive.hpp"
#include "engine/contact/linear_damped.hpp"

namespace loam::engine {
namespace {

using Cohesive = LinearCohesiveContact<double, bool>;
using Damped = LinearDampedContact<double, bool>;
using Hertz = HertzMindlinContact<double, bool>;
using std::numbers::pi;

constexpr double density = 2650, radius_0 = 0.05, radius_1 = 0.02, reduced = 0.05 * 0.02 / 0.07;

Touch<double> touch(double overlap) {
    const double smaller = std::min(radius_0, radius_1);
    return {overlap, radius_0 + radius_1, radius_1 - radius_0, reduced, smaller * smaller};
}

/// A sphere of radius_0 and a plane; the reduced radius is the sphere's.
Touch<double> touch_wall(double overlap) {
    return {overlap, radius_0, -radius_0, radius_0, radius_0 * radius_0};
}

LawNumbers numbers_of(const ContactLaw& law) {
    return compose(law, density, true).numbers;
}

double mass_of(double radius) {
    return 4.0 / 3.0 * pi * radius * radius * radius * density;
}

TEST(LinearDampedLaw, HasTheNumbersOfItsPaper) {
    // GRAPE, Table 1: E 110 MPa, k_t = k_n / 1.2, mu 0.17, D 0.1.
    LinearDamped law;
    law.young_modulus = 1.1e8;
    law.friction_angle = std::atan(0.17);
    const LawNumbers n = numbers_of(law);
    const Damped contact(n, touch(1e-5), bond_none, false);
    const double kn = 6.047565858e6;  // pi/4 · 1.1e8 · 0.07
    EXPECT_NEAR(contact.kn / kn, 1, 1e-9);
    EXPECT_NEAR(contact.kt / (kn / 1.2), 1, 1e-9);
    EXPECT_NEAR(contact.force / (kn * 1e-5), 1, 1e-9);
    const double m = mass_of(radius_0) * mass_of(radius_1) / (mass_of(radius_0) + mass_of(radius_1));
    EXPECT_NEAR(contact.normal_dashpot() / (2 * 0.1 * std::sqrt(m * kn)), 1, 1e-9);
    EXPECT_NEAR(contact.shear_dashpot() / (2 * 0.1 * std::sqrt(m * kn / 1.2)), 1, 1e-9);
    EXPECT_NEAR(contact.shear_limit(10), 1.7, 1e-12);
    EXPECT_EQ(contact.shear_limit(-10), 0);
    EXPECT_FALSE(Damped(n, touch(-1e-12), bond_cohesive, true).active);
    // A wall does not move: the mass is the sphere's.
    const Damped at_wall(n, touch_wall(1e-5), bond_none, false);
    EXPECT_NEAR(at_wall.normal_dashpot() / (2 * 0.1 * std::sqrt(mass_of(radius_0) * at_wall.kn)), 1, 1e-9);
}

TEST(HertzMindlinLaw, HasTheNumbersOfItsEquations) {
    HertzMindlin law;
    law.young_modulus = 5e8;
    law.poisson_ratio = 0.3;
    law.friction_angle = std::atan(0.4);
    law.restitution = 0.5;
    const LawNumbers n = numbers_of(law);
    for (const double overlap : {1e-8, 1e-5, 1e-3}) {
        const Hertz contact(n, touch(overlap), bond_none, false);
        const double a = std::sqrt(reduced * overlap), y = 5e8 / (2 * 0.91), g = 5e8 / (4 * 1.3 * 1.7);
        EXPECT_NEAR(contact.force / (4.0 / 3.0 * y * a * overlap), 1, 1e-12);
        EXPECT_NEAR(contact.kn / (2 * y * a), 1, 1e-12);
        EXPECT_NEAR(contact.kt / (8 * g * a), 1, 1e-12);
        EXPECT_NEAR(contact.kt / contact.kn, 2 * 0.7 / 1.7, 1e-12);  // Mindlin 1949
        const double m = mass_of(radius_0) * mass_of(radius_1) / (mass_of(radius_0) + mass_of(radius_1));
        const double beta = std::log(2.0) / std::hypot(std::log(2.0), pi);
        EXPECT_NEAR(contact.normal_dashpot() / (2 * std::sqrt(5.0 / 6.0) * beta * std::sqrt(2 * y * a * m)),
                    1, 1e-12);
        EXPECT_NEAR(contact.shear_dashpot() / (2 * std::sqrt(5.0 / 6.0) * beta * std::sqrt(8 * g * a * m)), 1,
                    1e-12);
        EXPECT_NEAR(contact.shear_limit(10), 4, 1e-12);
    }
    const Hertz apart(n, touch(-1e-6), 1e5, true);
    EXPECT_FALSE(apart.active);
    EXPECT_EQ(apart.shear_rescale(), 0);  // and leaves no shear force behind
}

/// Central differences over a ten-thousandth of `scale`: their error is of the order 1e-9, rounding 1e-12.
template <class Law>
void expect_force_is_the_slope(const ContactLaw& of, double overlap, double scale, double state) {
    const LawNumbers n = numbers_of(of);
    const double h = 1e-4 * scale;
    const auto at = [&](double u) { return Law(n, touch(u), state, true); };
    const auto energy = [&](double u) {
        const Law law = at(u);
        return 0.5 * law.twice_stored(law.force, u);
    };
    const Law here = at(overlap);
    ASSERT_TRUE(here.active) << overlap;
    const double slope = (energy(overlap + h) - energy(overlap - h)) / (2 * h);
    EXPECT_NEAR(slope, here.force, 1e-8 * here.kn * scale) << overlap;
}

template <class Law>
void expect_stiffness_is_the_slope(const ContactLaw& of, double overlap, double scale) {
    const LawNumbers n = numbers_of(of);
    const double h = 1e-4 * scale;
    const auto force = [&](double u) { return Law(n, touch(u), bond_cohesive, true).force; };
    const double kn = Law(n, touch(overlap), bond_cohesive, true).kn;
    EXPECT_NEAR((force(overlap + h) - force(overlap - h)) / (2 * h) / kn, 1, 1e-8) << overlap;
}

TEST(Laws, ForceIsTheSlopeOfTheStoredEnergyAndStiffnessThatOfTheForce) {
    LinearCohesive fragile, lasting;
    fragile.normal_cohesion = lasting.normal_cohesion = 1e6;
    lasting.fragile = false;
    for (const double overlap :
         {-2e-5, 0.3e-5, 1e-4, 1e-3}) {  // tension up to 1e6 · 0.02² N / k_n = 4.4e-5 m
        expect_force_is_the_slope<Cohesive>(fragile, overlap, 1e-5, bond_cohesive);
        expect_force_is_the_slope<Cohesive>(lasting, overlap, 1e-5, bond_cohesive);
        expect_stiffness_is_the_slope<Cohesive>(fragile, overlap, 1e-5);
    }
    for (const double overlap : {-1e-4, -1e-3, -0.03})  // its plateau
        expect_force_is_the_slope<Cohesive>(lasting, overlap, 1e-5, bond_cohesive);
    for (const double overlap : {1e-8, 1e-5, 1e-3}) {
        expect_force_is_the_slope<Damped>(LinearDamped{}, overlap, overlap, bond_cohesive);
        expect_force_is_the_slope<Hertz>(HertzMindlin{}, overlap, overlap, 1e5);
        expect_stiffness_is_the_slope<Damped>(LinearDamped{}, overlap, overlap);
        expect_stiffness_is_the_slope<Hertz>(HertzMindlin{}, overlap, overlap);
    }
}

TEST(HertzMindlinLaw, AChangeOfTheOverlapNeverMakesShearEnergy) {
    // T²/(2 k_t) before and after, for every pair of overlaps; a spring k_t(u) times its displacement would
    // gain where the overlap grows.
    const LawNumbers n = numbers_of(HertzMindlin{});
    for (const double before : {1e-7, 1e-6, 3e-6, 1e-4})
        for (const double after : {1e-7, 1e-6, 3e-6, 1e-4, 1e-3}) {
            const double kt = Hertz(n, touch(before), bond_none, false).kt;
            const Hertz now(n, touch(after), kt, true);
            const double force = now.shear_rescale();  // of 1 N
            EXPECT_LE(force * force / now.kt, 1 / kt * (1 + 1e-14)) << before << " " << after;
            EXPECT_NEAR(force, after < before ? std::sqrt(after / before) : 1, 1e-14);
        }
}

}  // namespace
}  // namespace loam::engine
