// The loop over contacts, for any law and any way of turning.
#pragma once

#include "engine/kernel/columns.hpp"
#include "engine/kernel/contact_sums.hpp"

namespace loam::engine {
namespace {

/// How the two particles of `lanes` pairs stand and move.
struct Geometry {
    Column3 branch, velocity;  // of j relative to i; velocity without the mean field
    Column radius_difference, inverse_d, overlap;
};

LOAM_INLINE void find_geometry(const ContactArguments& a, std::size_t k, Geometry& g) {
    Column r[8];
    gather_differences(a, k, r);
    g.branch = {r[0], r[1], r[2]};
    g.velocity = {r[4], r[5], r[6]};
    g.radius_difference = r[3];
    const Column d2 = dot(g.branch, g.branch);
    g.inverse_d = inverse_sqrt(d2);
    g.overlap = load(a.radius_sum + k) - d2 * g.inverse_d;
}

/// Shear of `lanes` pairs in one step.
struct Shear : SpringStep {
    Column3 force;      // on i: spring and dashpot
    Column3 slip_rate;  // only where a law has dashpots
    Mask sliding;
};

/// Coulomb's limit on a law without dashpots.
template <class Law>
LOAM_INLINE void limit_shear(const Law& law, Column fn, Shear& s) {
    const Column zero = splat(0.0), one = splat(1.0), limit = law.shear_limit(fn), s2 = dot(s.trial, s.trial);
    s.sliding = (s2 > limit * limit) & law.active;
    Column scale = choose(law.active, one, zero);
    if (any(s.sliding))
        scale = choose(s.sliding, law.shear_limit_of_sliding(fn) * inverse_sqrt(choose(s.sliding, s2, one)),
                       scale);
    s.now = s.force = scaled(scale, s.trial);
}

/// The same where a dashpot stands beside the spring, both in series with the slider: the limit holds for
/// their sum, and the spring and the dashpot give way together. With a = c / (k dt), force = spring + a
/// (spring - before).
template <class Law>
LOAM_INLINE void limit_damped_shear(const Law& law, Column fn, Column kt_dt, Shear& s) {
    const Column zero = splat(0.0), one = splat(1.0), limit = law.shear_limit(fn);
    const Column dashpot = law.shear_dashpot();
    const Column3 both = plus_scaled(s.trial, dashpot, s.slip_rate);
    const Column s2 = dot(both, both), on = choose(law.active, one, zero);
    s.sliding = (s2 > limit * limit) & law.active;
    s.force = scaled(
        choose(s.sliding, law.shear_limit_of_sliding(fn) * inverse_sqrt(choose(s.sliding, s2, one)), on),
        both);
    s.now = scaled(on, s.trial);
    if (!any(s.sliding)) return;
    const Mask springy = kt_dt > zero;
    const Column a = dashpot / choose(springy, kt_dt, one), share = one / (one + a);
    const Column3 before = minus_scaled(s.trial, kt_dt, s.slip_rate);
    const Column3 yielding = scaled(share, plus_scaled(s.force, a, before));
    const Mask spring_slides = s.sliding & springy;
    s.now = {choose(spring_slides, yielding.x, s.now.x), choose(spring_slides, yielding.y, s.now.y),
             choose(spring_slides, yielding.z, s.now.z)};
}

/// What turning particles add to the motion of a contact.
struct Turn {
    Column3 spin;  // R_i ω_i + R_j ω_j
    Column twist;  // by which the contact frame turns about the normal in a step
};

/// Shear history grows by the shear displacement and follows the normal's turning: one projection for both.
/// The displacement is enlarged by (R_i+R_j)/d, so that a closed cycle of motion leaves no shear behind
/// (granular ratcheting).
template <class Law, Turning turning>
LOAM_INLINE void advance_shear(const ContactArguments& a, std::size_t k, const Law& law, Column radius_sum,
                               Column inverse_d, const Column3& velocity, const Column3& normal,
                               const Turn& turn, Shear& s) {
    Column3 shear = {load(a.shear_x + k), load(a.shear_y + k), load(a.shear_z + k)};
    if constexpr (Law::rescales) shear = scaled(law.shear_rescale(), shear);
    const Column kt_dt = a.dt * law.kt;
    s.stiffness = law.kt;
    s.before = shear;
    if constexpr (turning != Turning::blocked) {
        s.before = plus_scaled(shear, turn.twist, cross(normal, shear));
        shear = minus_scaled(s.before, kt_dt, cross(turn.spin, normal));
    }
    shear = plus_scaled(shear, kt_dt * radius_sum * inverse_d, velocity);
    s.trial = minus_scaled(shear, dot(shear, normal), normal);
    if constexpr (Law::viscous) {
        Column3 rate = scaled(radius_sum * inverse_d, velocity);
        if constexpr (turning != Turning::blocked) rate = minus(rate, cross(turn.spin, normal));
        s.slip_rate = minus_scaled(rate, dot(rate, normal), normal);
    }
}

LOAM_INLINE void store3(double* x, double* y, double* z, const Column3& c) {
    store(x, c.x);
    store(y, c.y);
    store(z, c.z);
}

/// One over a radius, which is zero at a wall.
LOAM_INLINE Column over_radius(Column radius) {
    const Mask real = radius > splat(0.0);
    return choose(real, inverse(choose(real, radius, splat(1.0))), splat(0.0));
}

/// The rolling moment on i in one step, and as it was kept from the last one.
struct RollingStep : SpringStep {
    Column3 kept;
    Column kept_stiffness;
};

/// Rolling moment on i of `lanes` pairs: a spring against the difference of the spins across the contact, up
/// to rolling_friction · F_n · min(R_i, R_j).
template <class Law>
LOAM_INLINE void resist_rolling(const ContactArguments& a, std::size_t k, const Law& law,
                                const Touch<Column>& pair, Column fn, const Column3& normal, Column twist,
                                RollingStep& r) {
    const Column zero = splat(0.0), one = splat(1.0);
    double *const x = a.further[0] + k, *const y = a.further[1] + k, *const z = a.further[2] + k;
    Column3 moment = {load(x), load(y), load(z)};
    const Column radii = a.law.rolling_stiffness * pair.reduced_radius * pair.radius_sum;
    r.stiffness = law.kt * radii;
    if constexpr (Law::rescales) {
        r.kept = moment;
        r.kept_stiffness = law.last_kt * radii;
        moment = scaled(law.shear_rescale(), moment);
    }
    r.before = plus_scaled(moment, twist, cross(normal, moment));
    moment = plus_scaled(r.before, a.dt * r.stiffness, gather_spin_differences(a, k));
    r.trial = minus_scaled(moment, dot(moment, normal), normal);
    const Column limit = a.law.rolling_friction * choose(fn > zero, fn, zero) * square_root(pair.area);
    const Column m2 = dot(r.trial, r.trial);
    const Mask yields = (m2 > limit * limit) & law.active;
    const Column scale =
        choose(yields, limit * inverse_sqrt(choose(yields, m2, one)), choose(law.active, one, zero));
    r.now = scaled(scale, r.trial);
    store3(x, y, z, r.now);
}

/// Where the effects' memory of a contact stands in its further history.
template <Turning turning>
constexpr int memory_at = turning == Turning::resisted ? 3 : 0;

/// The law on `lanes` pairs; `state` is what they kept of it.
template <class Law, Turning turning>
LOAM_INLINE Law law_on(const ContactArguments& a, std::size_t k, const Touch<Column>& pair, Column state,
                       Mask touching) {
    if constexpr (Law::has_effects) {
        double* const* memory = a.further + memory_at<turning>;
        return Law(a.law, pair, state, {load(memory[0] + k), load(memory[1] + k), load(memory[2] + k)});
    } else {
        return Law(a.law, pair, state, touching);
    }
}

template <Turning turning, class Memory>
LOAM_INLINE void store_memory(const ContactArguments& a, std::size_t k, const Memory& now) {
    double* const* memory = a.further + memory_at<turning>;
    store3(memory[0] + k, memory[1] + k, memory[2] + k, {now.kt, now.largest, now.cement});
}

/// What the contacts took out of the motion in this step; `damping` is the power of the normal dashpots. To
/// be called before the new history is stored.
template <Turning turning, class Law>
LOAM_INLINE void add_losses(const ContactArguments& a, std::size_t k, const Law& law,
                            const Touch<Column>& pair, Mask touching, Column damping, const Shear& s,
                            const RollingStep& rolling, ContactLanes& totals) {
    if constexpr (Law::rescales)
        totals.add_rescale({load(a.shear_x + k), load(a.shear_y + k), load(a.shear_z + k)}, law.last_kt,
                           s.before, law.kt);
    if constexpr (Law::has_effects) totals.lost += law.lost();
    if constexpr (Law::viscous) {
        totals.add_damped_sliding(s, s.force, scaled(splat(a.dt), s.slip_rate));
        totals.lost += a.dt * damping;
    } else {
        const Mask ended = touching & ~law.active;
        if (any(s.sliding | ended)) {
            totals.add_sliding(s);
            if constexpr (!Law::has_effects)
                totals.lost += choose(ended, 0.5 * law.twice_stored(law.force, pair.overlap), splat(0.0));
        }
    }
    if constexpr (turning == Turning::resisted) {
        totals.add_sliding(rolling);
        if constexpr (Law::rescales)
            totals.add_rescale(rolling.kept, rolling.kept_stiffness, rolling.before, rolling.stiffness);
    }
}

/// Forces of `lanes` pairs: applies the law to columns, transposes back and adds. Lanes that do not touch
/// give zero force and zero history.
template <template <class, class> class LawOf, Turning turning, Measure measure>
LOAM_INLINE void add_forces(const ContactArguments& a, std::size_t k, const Geometry& g,
                            ContactLanes& totals) {
    using Law = LawOf<Column, Mask>;
    const Column zero = splat(0.0);
    const Touch<Column> pair = {g.overlap, load(a.radius_sum + k), g.radius_difference,
                                load(a.reduced_radius + k), load(a.area + k)};
    const Column state = load(a.bond + k);
    const Mask touching = state > bond_none;
    const Law law = law_on<Law, turning>(a, k, pair, state, touching);
    if (!any(law.active | touching)) return;
    const Column elastic = choose(law.active, law.force, zero);
    const Column3 normal = scaled(g.inverse_d, g.branch);
    const Column3 mean = along_gradient(a.velocity_gradient, g.branch);
    const Column3 velocity = {g.velocity.x + mean.x, g.velocity.y + mean.y, g.velocity.z + mean.z};
    Turn turn = {};
    if constexpr (turning != Turning::blocked) {
        turn.spin = gather_spin_sums(a, k);
        turn.twist = a.dt * dot(turn.spin, normal) * inverse(pair.radius_sum);
    }
    Shear s;
    advance_shear<Law, turning>(a, k, law, pair.radius_sum, g.inverse_d, velocity, normal, turn, s);
    Column fn = elastic, closing = zero;
    if constexpr (Law::viscous) {
        closing = zero - dot(velocity, normal);
        fn += choose(law.active, law.normal_dashpot() * closing, zero);
        limit_damped_shear(law, fn, a.dt * law.kt, s);
    } else {
        limit_shear(law, fn, s);
    }
    Column net = fn;
    if constexpr (Law::has_effects) net -= law.pull();
    const Column3 f = minus_scaled(s.force, net, normal);  // on i
    RollingStep rolling;
    if constexpr (turning == Turning::blocked) {
        scatter_forces(a, k, f);
    } else {
        // The contact parts the branch as the radii: moments over the radii are equal, and the moments
        // balance the couple of the shear forces.
        const Column share = (pair.radius_sum - pair.overlap) * inverse(pair.radius_sum);
        const Column3 moment = scaled(share, cross(normal, s.force));
        if constexpr (turning == Turning::resisted) {
            resist_rolling(a, k, law, pair, fn, normal, turn.twist, rolling);
            const Column of_i = 0.5 * (pair.radius_sum - g.radius_difference),
                         of_j = 0.5 * (pair.radius_sum + g.radius_difference);
            scatter_forces_and_moments(a, k, f, plus_scaled(moment, over_radius(of_i), rolling.now),
                                       minus_scaled(moment, over_radius(of_j), rolling.now));
        } else {
            scatter_forces_and_moment(a, k, f, moment);
        }
    }
    if constexpr (measure != Measure::nothing) {
        totals.power -= dot(f, mean);
        add_losses<turning>(a, k, law, pair, touching, (fn - elastic) * closing, s, rolling, totals);
    }
    if constexpr (measure == Measure::all) {
        totals.add_contacts(law.active, f, g.branch, net, law.kn, pair.overlap, pair.radius_sum);
        if constexpr (Law::has_effects)
            totals.add_stored(s.now, law.kt, law.twice_stored());
        else
            totals.add_stored(s.now, law.kt, law.twice_stored(elastic, pair.overlap));
        if constexpr (turning == Turning::resisted) totals.add_stored(rolling.now, rolling.stiffness, zero);
    }
    store3(a.shear_x + k, a.shear_y + k, a.shear_z + k, s.now);
    if constexpr (Law::has_effects) {
        const auto memory = law.next_memory(s.sliding);
        totals.cement += memory.cement;
        store_memory<turning>(a, k, memory);
        store(a.bond + k, law.next_state(s.sliding));
    } else {
        store(a.bond + k, choose(law.active, law.next_state(s.sliding), zero));
    }
}

/// Contact forces of all pairs, as many at a time as there are lanes. Geometry runs ahead by a block: what
/// waits for its square roots and what waits for the law then overlap with work of other groups.
template <template <class, class> class LawOf, Turning turning, Measure measure>
void contact_forces(const ContactArguments& a, ContactSums& sums) {
    constexpr std::size_t block = 8;
    ContactLanes totals;
    Geometry geometry[block];
    for (std::size_t start = 0; start < a.padded_pairs; start += lanes * block) {
        const std::size_t left = (a.padded_pairs - start) / lanes, groups = left < block ? left : block;
        for (std::size_t g = 0; g < groups; ++g) find_geometry(a, start + lanes * g, geometry[g]);
        for (std::size_t g = 0; g < groups; ++g)
            add_forces<LawOf, turning, measure>(a, start + lanes * g, geometry[g], totals);
    }
    if constexpr (measure != Measure::nothing) totals.finish(sums);
}

}  // namespace
}  // namespace loam::engine
