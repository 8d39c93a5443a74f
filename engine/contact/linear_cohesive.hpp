// The law `linear-cohesive`:
//
//   F_n = k_n u_n >= -a_n,  |F_t| <= max(0, F_n tan(phi) + a_t),  k_n = modulus * R1 R2/(R1+R2) with modulus
//   2E, k_t = ratio * k_n,  a = C min(R1, R2)^2        (De Pue et al. 2019, eqs 1-7; here compression is
//   positive)
//
// u_n is the overlap (m, negative for a gap), F_t the shear force on the first particle, updated
// incrementally by the caller. Fragile contacts lose both adhesions when the tension exceeds a_n or the shear
// exceeds its limit, and have them again only after separating and touching again; contacts that are not
// fragile hold the tension a_n (eq. 1) up to the interaction range.
// T is a vector of doubles or a double, for which the includer has a choose(mask, a, b). A law knows no
// history: the caller passes the contact's state in and keeps what comes out.
#pragma once

#include "engine/contact/law_numbers.hpp"

namespace loam::engine {
namespace {

template <class T, class Mask>
struct LinearCohesiveContact {
    static constexpr bool viscous = false, rescales = false, has_effects = false;

    const LawNumbers& numbers;
    T kn, kt;     // N/m
    T force;      // F_n (N), compression positive; holds where active
    Mask active;  // the contact exists
    T cohesive;   // 1 where cohesion acts, else 0
    T area;

    /// `state`: a bond state; `touching`: the contact existed before this step.
    inline __attribute__((always_inline))
    LinearCohesiveContact(const LawNumbers& n, const Touch<T>& pair, T state, Mask touching)
        : numbers(n), area(pair.area) {
        const T zero = state * 0.0, one = zero + 1.0;
        cohesive = choose(state == bond_broken + zero, zero, one);  // a new contact is cohesive
        kn = n.normal_modulus * pair.reduced_radius;
        kt = n.stiffness_ratio * kn;
        const T adhesion = cohesive * (n.normal_cohesion * area), range = n.tension_range * pair.radius_sum;
        force = kn * pair.overlap;
        const Mask within = touching & (-pair.overlap < range) & (adhesion > zero);
        if (n.fragile) {
            active = (pair.overlap > zero) | (within & (-force <= adhesion));
        } else {
            force = choose(force < -adhesion, -adhesion, force);
            active = (pair.overlap > zero) | within;
        }
    }
    /// Largest shear force (N) under the normal force `fn`, and the one that is left once it has been passed.
    inline __attribute__((always_inline)) T shear_limit(T fn) const {
        return limit_with(fn, cohesive * (numbers.shear_cohesion * area));
    }
    inline __attribute__((always_inline)) T shear_limit_of_sliding(T fn) const {
        return numbers.fragile ? limit_with(fn, area * 0.0) : shear_limit(fn);
    }
    /// The state to keep.
    inline __attribute__((always_inline)) T next_state(Mask sliding) const {
        const T one = area * 0.0 + 1.0, bond = cohesive + one;
        return numbers.fragile ? choose(sliding, one, bond) : bond;
    }
    /// Twice the work that led to the normal force (J): a spring's, or beyond its limit a plateau's.
    inline __attribute__((always_inline)) T twice_stored(T fn, T overlap) const {
        return fn * (2.0 * overlap - fn / kn);
    }

  private:
    inline __attribute__((always_inline)) T limit_with(T fn, T adhesion) const {
        const T limit = fn * numbers.friction_coefficient + adhesion;
        return choose(limit > limit * 0.0, limit, limit * 0.0);
    }
};

}  // namespace
}  // namespace loam::engine
