#include "engine/contact/composition.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/require.hpp"

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

using std::numbers::pi;

void resolve(const LinearCohesive& law, LawNumbers& n) {
    n.normal_modulus = 2 * law.young_modulus;
    n.stiffness_ratio = law.stiffness_ratio;
    n.friction_coefficient = std::tan(law.friction_angle);
    n.normal_cohesion = law.normal_cohesion;
    n.shear_cohesion = law.shear_cohesion;
    n.tension_range = law.interaction_range - 1;
    n.fragile = law.fragile;
}

void resolve(const LinearDamped& law, LawNumbers& n) {
    n.normal_modulus = 0.25 * pi * law.young_modulus;
    n.stiffness_ratio = law.stiffness_ratio;
    n.friction_coefficient = std::tan(law.friction_angle);
    n.normal_damping = 2 * law.normal_damping;
    n.tangential_damping = 2 * law.tangential_damping;
}

/// beta of the coefficient of restitution: the share of critical damping of a linear spring.
double damping_of_restitution(double restitution) {
    if (restitution < 1e-12) return 1;
    const double log = std::log(restitution);
    return -log / std::hypot(log, pi);
}

void resolve(const HertzMindlin& law, LawNumbers& n) {
    const double nu = law.poisson_ratio;
    n.normal_modulus = law.young_modulus / (1 - nu * nu);             // 2 Y
    n.shear_modulus = 2 * law.young_modulus / ((1 + nu) * (2 - nu));  // 8 G
    n.friction_coefficient = std::tan(law.friction_angle);
    n.normal_damping = n.tangential_damping =
        2 * std::sqrt(5.0 / 6.0) * damping_of_restitution(law.restitution);
}

/// Dashpots of share D shorten the stable time step of one contact by sqrt(1 + D²) - D. A sphere in a packing
/// has several, whose dashpots add up where its frequency grows with their root alone: D counts 3.5 times,
/// found where packings of 5 contacts a sphere cease to come to rest.
double stiffened(double modulus, double damping_share) {
    const double share = 3.5 * damping_share, factor = std::hypot(1.0, share) - share;
    return modulus / (factor * factor);
}

double wave_modulus_of(const LinearCohesive& law, double) {
    return law.young_modulus;
}
double wave_modulus_of(const LinearDamped& law, double) {
    return stiffened(0.5 * pi * law.young_modulus, std::max(law.normal_damping, law.tangential_damping));
}
double wave_modulus_of(const HertzMindlin& law, double overlap) {
    // Equal spheres: a = R sqrt(overlap / 2R), k_n = 2 Y a.
    const double modulus = law.young_modulus / (1 - law.poisson_ratio * law.poisson_ratio);
    return stiffened(modulus * std::sqrt(overlap),
                     std::sqrt(5.0 / 6.0) * damping_of_restitution(law.restitution));
}

/// A wall is rigid and does not stick: all of the overlap is the sphere's, half of what two equal spheres
/// share. The laws see a partner of radius zero and a reduced radius R. That makes a spring of the reduced
/// radius twice as stiff as between equal spheres, and a Hertzian contact one with a plane; a spring of the
/// sum of radii has to be told.
LawNumbers numbers_at_wall(const ContactLaw& law, LawNumbers n) {
    n.normal_cohesion = n.shear_cohesion = 0;
    if (std::holds_alternative<LinearDamped>(law.base)) n.normal_modulus *= 4;
    return n;
}

template <template <class, class> class LawOf>
double force_of(const LawNumbers& n, const Touch<double>& pair, double bond) {
    const LawOf<double, bool> law(n, pair, bond, bond > bond_none);
    return law.force;
}

}  // namespace

Composition compose(const ContactLaw& law, double grain_density, bool free_rotation) {
    law.validate();
    Composition out;
    out.base = law.base.index();
    std::visit([&](const auto& base) { resolve(base, out.numbers); }, law.base);
    out.numbers.mass_of_unit_sphere = 4.0 / 3.0 * pi * grain_density;
    out.turning = free_rotation ? Turning::free : Turning::blocked;
    if (law.rolling.friction > 0) {
        require(free_rotation, "rolling_friction", law.rolling.friction, "0 where rotations are blocked");
        out.turning = Turning::resisted;
        out.history = 3;  // the moment
        out.numbers.rolling_friction = law.rolling.friction;
        out.numbers.rolling_stiffness = law.rolling.stiffness;
    }
    out.at_wall = numbers_at_wall(law, out.numbers);
    return out;
}

double wave_modulus(const ContactLaw& law, const Composition& composition, double overlap) {
    const double modulus =
        std::visit([&](const auto& base) { return wave_modulus_of(base, overlap); }, law.base);
    if (composition.turning == Turning::blocked) return modulus;
    // A sphere's spin is held by k_t R² + k_r = k_t R² (1 + k_r/(k_t R²)) at each contact, against 0.4 m R²;
    // the factor was found where packings of 6 contacts a sphere cease to come to rest.
    const LawNumbers& n = composition.numbers;
    const double ratio = n.stiffness_ratio > 0 ? n.stiffness_ratio : n.shear_modulus / n.normal_modulus;
    return modulus * std::max(1.0, 1.25 * ratio * (1 + n.rolling_stiffness));
}

bool stiffens(const ContactLaw& law) {
    return std::holds_alternative<HertzMindlin>(law.base);
}

double normal_force(const Composition& composition, const Touch<double>& pair, double bond) {
    using Force = double (*)(const LawNumbers&, const Touch<double>&, double);
    static constexpr Force forces[] = {force_of<LinearCohesiveContact>, force_of<LinearDampedContact>,
                                       force_of<HertzMindlinContact>};
    // A contact that rests on the plateau of its tension, or was torn in the last step, is still one.
    const double force = forces[composition.base](composition.numbers, pair, bond);
    const double adhesion = bond == bond_cohesive ? composition.numbers.normal_cohesion * pair.area : 0.0;
    return std::max(force, -adhesion);
}

}  // namespace loam::engine
