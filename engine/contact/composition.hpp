// A contact law resolved: what the step needs of it, found once and not looked up again.
#pragma once

#include <array>

#include "engine/contact/contact_law.hpp"
#include "engine/kernel/kernel.hpp"

namespace loam::engine {

struct Composition {
    LawNumbers numbers{};
    LawNumbers at_wall{};     // the same law against a flat wall, but for the friction, which is the wall's
    std::size_t base = 0;     // which base law, in the order of ContactLaw::base
    std::size_t history = 0;  // doubles for each contact beyond shear force and bond
    Turning turning = Turning::blocked;
    bool with_effects = false;  // of those in contact/with_effects.hpp

    /// Where the effects' memory stands in the history.
    std::size_t memory() const { return history - 3; }
};

/// Throws std::invalid_argument where an effect lacks its partner: rolling resistance needs free rotation.
/// Effects of strength 0 are left out, so that the base law remains bit for bit.
Composition compose(const ContactLaw& law, double grain_density, bool free_rotation);

/// Young moduli (Pa) that the p-wave estimate of the time step min R sqrt(rho/E) needs for this law: for
/// springs k_n = E R between equal spheres E or, as the shear springs are soft, less; more for dashpots.
struct WaveModuli {
    double moving = 0;   // of the spheres' positions
    double turning = 0;  // of their spins, of solid spheres; 0 where rotation is blocked
};

/// `overlap`: largest over R_i + R_j, which only springs that stiffen depend on.
WaveModuli wave_moduli(const ContactLaw& law, const Composition& composition, double overlap);

/// Whether wave_moduli depend on the overlap.
bool stiffens(const ContactLaw& law);

/// Elastic normal force (N, compression positive) of a pair under a law, with that of its liquid bridge.
/// `bond` and `memory` (kt, largest overlap, cement; only read with effects) are its state after the step.
double normal_force(const Composition& composition, const Touch<double>& pair, double bond,
                    const std::array<double, 3>& memory);

}  // namespace loam::engine
