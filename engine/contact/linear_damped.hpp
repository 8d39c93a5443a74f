// The law `linear-damped`, that of GRAPE (Fraunhofer ITWM; "Triaxial compression and direct shear tests in
// the parametrization of soil modeled via the discrete element method", eqs 1-2 and Table 1):
//
//   F_n = k_n u_n + d_n du_n/dt,  F_t = k_t u_t + d_t du_t/dt,  |F_t| <= mu F_n,
//   k_n = pi/4 E (R1 + R2),  k_t = ratio * k_n,  d = 2 D sqrt(m k),  m = m1 m2/(m1 + m2)
//
// The contact lasts as long as the overlap; near its end the dashpot may pull, as eq. 2 has it. T is a vector
// of doubles or a double, for which the includer has choose and square_root.
#pragma once

#include "engine/contact/law_numbers.hpp"

namespace loam::engine {
namespace {

/// m1 m2 / (m1 + m2) (kg); a partner of radius zero is a point of a wall, whose mass is infinite.
template <class T>
static inline __attribute__((always_inline)) T reduced_mass(const LawNumbers& n, const Touch<T>& pair) {
    const T a = 0.5 * (pair.radius_sum - pair.radius_difference);
    const T b = 0.5 * (pair.radius_sum + pair.radius_difference);
    const T a3 = a * a * a, b3 = b * b * b;
    return n.mass_of_unit_sphere * choose(b3 > b3 * 0.0, a3 * b3 / (a3 + b3), a3);
}

template <class T, class Mask>
struct LinearDampedContact {
    static constexpr bool viscous = true, rescales = false, has_effects = false;

    const LawNumbers& numbers;
    T kn, kt;  // N/m
    T force;   // elastic part of F_n (N)
    Mask active;
    T mass;

    inline __attribute__((always_inline))
    LinearDampedContact(const LawNumbers& n, const Touch<T>& pair, T, Mask)
        : numbers(n), mass(reduced_mass(n, pair)) {
        kn = n.normal_modulus * pair.radius_sum;
        kt = n.stiffness_ratio * kn;
        force = kn * pair.overlap;
        active = pair.overlap > pair.overlap * 0.0;
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
    inline __attribute__((always_inline)) T next_state(Mask) const { return kn * 0.0 + bond_cohesive; }
    inline __attribute__((always_inline)) T twice_stored(T fn, T overlap) const { return fn * overlap; }
};

}  // namespace
}  // namespace loam::engine
