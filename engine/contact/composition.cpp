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
// This needs the base laws.
#include "engine/contact/with_effects.hpp"

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

/// The meniscus of a bridge between equal spheres of radius 1 (contact/capillarity.hpp).
void resolve(const Capillarity& effect, LawNumbers& n) {
    n.bridge_length = 1;  // what is divided by must not be zero
    if (effect.suction == 0) return;
    const double a = effect.filling_angle, sec = 1 / std::cos(a), tan = std::tan(a);
    const double r1 = sec - 1, r2 = 1 + tan - sec;
    const double volume = 2 * pi * r1 * r1 * (1 - (0.5 * pi - a) * tan);
    n.bridge_force = pi * effect.suction * r2 * r2 * (r2 + r1) / (r2 - r1);
    n.bridge_length = std::sqrt(2 * volume / pi);
    n.bridge_reach = std::cbrt(volume);
}

void resolve_effects(const ContactLaw& law, Composition& out) {
    LawNumbers& n = out.numbers;
    n.normal_cohesion += law.adhesion.stress;
    n.shear_cohesion += law.adhesion.stress * law.adhesion.shear_ratio;
    n.cement_tension = law.cementation.strength;
    n.cement_shear = law.cementation.strength * law.cementation.shear_ratio;
    n.hertzian_share = law.hertzian.share;
    n.hertzian_scale = 1 / (4 * law.hertzian.reference_pressure);
    n.plastic_share = law.plastic.share;
    n.plastic_stiffening = 1 / (1 - law.plastic.share);
    resolve(law.capillarity, n);
    // linear-cohesive has bonds itself.
    const bool sticks = law.adhesion.stress > 0 && !std::holds_alternative<LinearCohesive>(law.base);
    out.with_effects =
        sticks || n.cement_tension > 0 || n.hertzian_share > 0 || n.plastic_share > 0 || n.bridge_force > 0;
    if (out.with_effects) out.history += 3;
}

/// Dashpots of share D shorten the stable time step of one contact by sqrt(1 + D²) - D. A sphere in a packing
/// has several, whose dashpots add up where its frequency grows with their root alone. Of Z contacts between
/// equal spheres, all of them moving against each other, D counts sqrt(Z) times, and sqrt(5 Z/3) times where
/// spheres turn against each other, their inertia being 2/5 of what it is along a path; 3.5 and 4.5 are for
/// Z = 12. Packings of 5 to 7 contacts a sphere then come to rest at up to 0.95 of the time step, a crystal
/// of 12 at up to 0.65.
double stiffened(double modulus, double damping_share, bool turns) {
    const double share = (turns ? 4.5 : 3.5) * damping_share, factor = std::hypot(1.0, share) - share;
    return modulus / (factor * factor);
}

double wave_modulus_of(const LinearCohesive& law, double, bool) {
    return law.young_modulus;
}
double wave_modulus_of(const LinearDamped& law, double, bool turns) {
    const double share = std::max(law.normal_damping, law.tangential_damping);
    return stiffened(0.5 * pi * law.young_modulus, share, turns);
}
double wave_modulus_of(const HertzMindlin& law, double overlap, bool turns) {
    // Equal spheres: a = R sqrt(overlap / 2R), k_n = 2 Y a.
    const double modulus = law.young_modulus / (1 - law.poisson_ratio * law.poisson_ratio);
    const double share = std::sqrt(5.0 / 6.0) * damping_of_restitution(law.restitution);
    return stiffened(modulus * std::sqrt(overlap), share, turns);
}

/// A wall does not stick and, like a Hertzian contact with a plane, is of the grains' material: its springs
/// are those between equal spheres. The laws see a partner of radius zero and a reduced radius R, and with
/// them a spring of the reduced radius would be twice as stiff, one of the sum of radii half.
LawNumbers numbers_at_wall(const ContactLaw& law, LawNumbers n) {
    n.normal_cohesion = n.shear_cohesion = n.bridge_force = n.bridge_reach = 0;
    if (std::holds_alternative<LinearCohesive>(law.base)) n.normal_modulus /= 2;
    if (std::holds_alternative<LinearDamped>(law.base)) n.normal_modulus *= 2;
    return n;
}

template <template <class, class> class LawOf>
double force_of(const LawNumbers& n, const Touch<double>& pair, double bond, const std::array<double, 3>&) {
    const LawOf<double, bool> law(n, pair, bond, bond > bond_none);
    return law.force;
}

template <template <class, class> class LawOf>
double force_with_effects(const LawNumbers& n, const Touch<double>& pair, double bond,
                          const std::array<double, 3>& memory) {
    const ContactWithEffects<LawOf, double, bool> law(n, pair, bond, {memory[0], memory[1], memory[2]});
    return (law.active ? law.force : 0.0) - law.pull();
}

/// The tangent stiffness of the spring of equal spheres over E R, of the linear laws with hertzian_stiffness.
double stiffness_over_linear(const LawNumbers& n, double modulus, double overlap) {
    const double s = n.hertzian_share;  // u k / (4 P R²) with u = 2 R overlap and k = modulus R
    return 1 - s + s * std::sqrt((1 - s / 3) * 2 * overlap * modulus * n.hertzian_scale);
}

/// The overlap over R_i + R_j at which equal spheres hold the largest tension; at most 1.
double overlap_in_tension(const LawNumbers& n, double modulus, bool hertzian) {
    const double stress = n.normal_cohesion + n.cement_tension;
    if (stress == 0) return 0;
    if (hertzian) return std::min(1.0, std::pow(0.75 * stress / n.normal_modulus, 2.0 / 3.0));
    double below = 0, above = 1;
    for (int k = 0; k < 50; ++k) {
        const double at = 0.5 * (below + above), tangent = stiffness_over_linear(n, modulus, at);
        const double secant = (1 - n.hertzian_share) / 3 + 2.0 / 3.0 * tangent;
        (2 * modulus * at * secant < stress ? below : above) = at;
    }
    return above;
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
    resolve_effects(law, out);
    out.at_wall = numbers_at_wall(law, out.numbers);
    return out;
}

WaveModuli wave_moduli(const ContactLaw& law, const Composition& composition, double overlap) {
    const LawNumbers& n = composition.numbers;
    const bool hertzian = std::holds_alternative<HertzMindlin>(law.base);
    const double linear =
        (std::holds_alternative<LinearCohesive>(law.base) ? 0.5 : 2.0) * n.normal_modulus;  // k = linear R
    if (composition.with_effects) overlap = std::max(overlap, overlap_in_tension(n, linear, hertzian));
    const bool turns = composition.turning != Turning::blocked;
    double modulus =
        std::visit([&](const auto& base) { return wave_modulus_of(base, overlap, turns); }, law.base);
    if (n.hertzian_share > 0) modulus *= std::max(1.0, stiffness_over_linear(n, linear, overlap));
    // Of the springs at a sphere the shear ones act along two directions of three and, where it turns, on its
    // spin: k_t R² + k_r = k_t R² (1 + k_r/(k_t R²)) at each contact, against 0.4 m R². The factors were
    // found where packings of linear springs cease to come to rest (ratios 0.05 to 1, 3 to 11.5 contacts a
    // sphere).
    const double ratio = n.stiffness_ratio > 0 ? n.stiffness_ratio : n.shear_modulus / n.normal_modulus;
    // The bridge's force changes fastest where the grains touch.
    return {modulus * (0.4 + 0.6 * ratio) * n.plastic_stiffening + n.bridge_force / n.bridge_length,
            turns ? modulus * 1.8 * ratio * (1 + n.rolling_stiffness) : 0.0};
}

bool stiffens(const ContactLaw& law) {
    return std::holds_alternative<HertzMindlin>(law.base) || law.hertzian.share > 0;
}

double normal_force(const Composition& composition, const Touch<double>& pair, double bond,
                    const std::array<double, 3>& memory) {
    using Force = double (*)(const LawNumbers&, const Touch<double>&, double, const std::array<double, 3>&);
    static constexpr Force forces[][2] = {
        {force_of<LinearCohesiveContact>, force_with_effects<LinearCohesiveContact>},
        {force_of<LinearDampedContact>, force_with_effects<LinearDampedContact>},
        {force_of<HertzMindlinContact>, force_with_effects<HertzMindlinContact>}};
    const double force =
        forces[composition.base][composition.with_effects](composition.numbers, pair, bond, memory);
    if (composition.with_effects) return force;
    // A contact that rests on the plateau of its tension, or was torn in the last step, is still one.
    const double adhesion = bond == bond_cohesive ? composition.numbers.normal_cohesion * pair.area : 0.0;
    return std::max(force, -adhesion);
}

}  // namespace loam::engine
