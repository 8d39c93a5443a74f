// The law `hertz-mindlin` (Sayakov et al., eqs 1-6):
//
//   F_n = 4/3 Y a u_n + g_n du_n/dt,  dF_t = 8 G a du_t + g_t du_t/dt,  |F_t| <= mu F_n,  a = sqrt(R u_n),
//   g = 2 sqrt(5/6) beta sqrt(S m),  S_n = 2 Y a,  S_t = 8 G a,
//   R = R1 R2/(R1 + R2),  Y = E/(2 (1 - nu²)),  G = E/(4 (1 + nu)(2 - nu)),
//   beta = -ln e/sqrt(ln² e + pi²) for the coefficient of restitution e
//
// Eq. 4 holds for a constant overlap. Where the overlap changes, a spring k_t(u_n) times the whole shear
// displacement would make energy out of nothing; so the shear force stays while the contact grows and shrinks
// with k_t when the contact does (Elata and Berryman 1996, Mech. Mater. 24, 229-240). The state of a contact
// is its last k_t. T is a vector of doubles or a double, for which the includer has choose and square_root.
#pragma once

#include "engine/contact/linear_damped.hpp"

namespace loam::engine {
namespace {

template <class T, class Mask>
struct HertzMindlinContact {
    static constexpr bool viscous = true, rescales = true, has_effects = false;

    const LawNumbers& numbers;
    T kn, kt;  // tangents (N/m)
    T force;   // elastic part of F_n (N)
    Mask active;
    T mass, last_kt;

    /// `state`: k_t of the step before, 0 for a new contact.
    inline __attribute__((always_inline))
    HertzMindlinContact(const LawNumbers& n, const Touch<T>& pair, T state, Mask)
        : numbers(n), mass(reduced_mass(n, pair)), last_kt(state) {
        const T zero = pair.overlap * 0.0;
        active = pair.overlap > zero;
        const T overlap = choose(active, pair.overlap, zero);
        const T radius = square_root(pair.reduced_radius * overlap);  // of the contact's circle
        kn = n.normal_modulus * radius;
        kt = n.shear_modulus * radius;
        force = (2.0 / 3.0) * kn * overlap;
    }
    /// What the shear force is multiplied by as the contact changes.
    inline __attribute__((always_inline)) T shear_rescale() const {
        const T one = kt * 0.0 + 1.0;
        const auto shrinks = kt < last_kt;
        return choose(shrinks, kt / choose(shrinks, last_kt, one), one);
    }
    inline __attribute__((always_inline)) T normal_dashpot() const {
        return numbers.normal_damping * square_root(mass * kn);
    }
    inline __attribute__((always_inline)) T shear_dashpot() const {
        return numbers.tangential_damping * square_root(mass * kt);
    }
    inline __attribute__((always_inline)) T shear_limit(T fn) const {
        const T limit = fn * numbers.friction_coefficient;
        return choose(limit > limit * 0.0, limit, limit * 0.0);
    }
    inline __attribute__((always_inline)) T shear_limit_of_sliding(T fn) const { return shear_limit(fn); }
    inline __attribute__((always_inline)) T next_state(Mask) const { return kt; }
    inline __attribute__((always_inline)) T twice_stored(T fn, T overlap) const { return 0.8 * fn * overlap; }
};

}  // namespace
}  // namespace loam::engine
