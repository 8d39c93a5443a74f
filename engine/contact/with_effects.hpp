// A base law with the effects adhesion, hertzian_stiffness, capillarity, cementation and plastic_contact,
// each of any strength. The base law gives spring, dashpots and friction; here are its bonds, its memory and
// its bridge:
//
//   normal force = spring(u) + dashpot - bridge,  spring(-u) = -spring(u),
//   in tension up to the cohesions of base law, adhesion and cement that still hold,
//   |F_t| <= max(0, (spring + dashpot) tan(phi) + their shear parts)
//
// A bond breaks, adhesion and cement at once, where the spring's tension or the shear force passes its limit;
// adhesion is renewed when the grains touch again, cement never. Friction goes with the force of the spring,
// which the bridge presses (Jiang and Yu 2006, section 3.2). T is a vector of doubles or a double, for which
// the includer has choose and square_root.
#pragma once

#include "engine/contact/capillarity.hpp"
#include "engine/contact/hertzian_stiffness.hpp"
#include "engine/contact/plastic_contact.hpp"

namespace loam::engine {
namespace {

/// What a contact keeps beyond shear force and bond; zero for a new one.
template <class T>
struct ContactMemory {
    T kt;       // of the last step (N/m)
    T largest;  // overlap (m)
    T cement;   // 1 while the cement holds
};

template <template <class, class> class BaseLaw, class T, class Mask>
struct ContactWithEffects {
    using Base = BaseLaw<T, Mask>;
    static constexpr bool viscous = Base::viscous, rescales = true, has_effects = true;

    const LawNumbers& numbers;
    const Touch<T>& pair;
    ContactMemory<T> before;
    T zero, one;
    PlasticOverlap<T> overlap;
    Mask in_tension;
    T spring_energy;  // twice the base law's (J)
    Base base;
    LiquidBridge<T> bridge;
    T kn, kt;     // tangents (N/m); of unloading where that is stiffer, as servos must reckon with
    T force;      // of the spring (N), compression positive; holds where active
    Mask active;  // spring and shear act
    Mask bridged;
    T last_kt;

    inline __attribute__((always_inline))
    ContactWithEffects(const LawNumbers& n, const Touch<T>& pair_now, T state, const ContactMemory<T>& memory)
        : numbers(n),
          pair(pair_now),
          before(memory),
          zero(state * 0.0),
          one(zero + 1.0),
          overlap(n, pair_now.overlap, memory.largest),
          in_tension(overlap.elastic < zero),
          base(spring_at(choose(in_tension, -overlap.elastic, overlap.elastic), spring_energy)),
          bridge(n, pair_now) {
        kn = base.kn * n.plastic_stiffening;
        kt = base.kt;
        last_kt = choose(memory.kt > zero, memory.kt, kt);
        force = choose(in_tension, -base.force, base.force);
        existed = state > zero;
        touched = existed & (state < bond_apart + zero);
        // Renewed on touching.
        cohesive = choose(touched & (state == bond_broken + zero), zero, one);
        const T tension = (cohesive * n.normal_cohesion + memory.cement * n.cement_tension) * pair.area;
        active = ((overlap.elastic > zero) & (pair.overlap > zero)) |
                 (touched & (tension > zero) & (-force <= tension));
        bridged = active | (existed & (pair.overlap > -bridge.reach));
    }
    inline __attribute__((always_inline)) T normal_dashpot() const { return base.normal_dashpot(); }
    inline __attribute__((always_inline)) T shear_dashpot() const { return base.shear_dashpot(); }
    inline __attribute__((always_inline)) T shear_rescale() const {
        const auto shrinks = kt < last_kt;
        return choose(shrinks, kt / choose(shrinks, last_kt, one), one);
    }
    /// Largest shear force (N) under the normal force `fn` without the bridge, and what is left beyond it.
    inline __attribute__((always_inline)) T shear_limit(T fn) const {
        return limit_with(
            fn, (cohesive * numbers.shear_cohesion + before.cement * numbers.cement_shear) * pair.area);
    }
    inline __attribute__((always_inline)) T shear_limit_of_sliding(T fn) const {
        return limit_with(fn, zero);
    }
    /// Attraction of the bridge (N).
    inline __attribute__((always_inline)) T pull() const { return choose(bridged, bridge.pull, zero); }

    /// The state to keep where the contact is active or not.
    inline __attribute__((always_inline)) T next_state(Mask sliding) const {
        const T apart = choose(bridged, zero + bond_apart, zero);
        return choose(active, choose(sliding, one, cohesive + one), apart);
    }
    inline __attribute__((always_inline)) ContactMemory<T> next_memory(Mask sliding) const {
        const Mask pressed = active | (bridged & (pair.overlap > zero));
        return {choose(active, kt, zero), choose(pressed, overlap.largest, zero),
                choose(sliding, zero, choose(active, before.cement, zero))};
    }
    /// Twice the energy of spring and bridge (J).
    inline __attribute__((always_inline)) T twice_stored() const {
        return choose(active, (1.0 - numbers.plastic_share) * spring_energy, zero) +
               choose(bridged, bridge.twice_energy, zero);
    }
    /// What was lost along the normal since the step before: by growing flat, torn springs and torn bridges
    /// (J).
    inline __attribute__((always_inline)) T lost() const {
        T energy_before, energy_now;
        spring_at(before.largest, energy_before);
        spring_at(overlap.largest, energy_now);
        const T flattened = choose(active, numbers.plastic_share * (energy_now - energy_before), zero);
        const T torn =
            choose(active, zero, choose(touched, (1.0 - numbers.plastic_share) * spring_energy, zero));
        const T ruptured = choose(bridged, zero, choose(existed, bridge.twice_energy, zero));
        return 0.5 * (flattened + torn + ruptured);
    }

  private:
    /// The base law's spring at an overlap >= 0, with twice its energy.
    inline __attribute__((always_inline)) Base spring_at(T at, T& twice_energy) const {
        Touch<T> there = pair;
        there.overlap = at;
        Base spring(numbers, there, zero, at < zero);
        twice_energy = spring.twice_stored(spring.force, at);
        if constexpr (!Base::rescales)
            if (numbers.hertzian_share > 0) stiffen_with_force(numbers, pair, at, spring, twice_energy);
        return spring;
    }
    inline __attribute__((always_inline)) T limit_with(T fn, T adhesion) const {
        const T limit = fn * numbers.friction_coefficient + adhesion;
        return choose(limit > zero, limit, zero);
    }

    Mask existed, touched;
    T cohesive;  // 1 where adhesion acts, else 0
};

// The base laws with effects, as the loops take them.
#define LOAM_LAW_WITH_EFFECTS(Law) \
    template <class T, class Mask> \
    using Law##WithEffects = ContactWithEffects<Law##Contact, T, Mask>

}  // namespace
}  // namespace loam::engine
