// The law `linear-cohesive` for several contacts at once: T is a vector of doubles, for which the includer
// has a choose(mask, a, b).
//
//   F_n = k_n u_n >= -a_n,  |F_t| <= max(0, F_n tan(phi) + a_t),  k_n = modulus * R1 R2/(R1+R2) with modulus
//   2E, k_t = ratio * k_n,  a = C min(R1, R2)^2        (De Pue et al. 2019, eqs 1-7; here compression is
//   positive)
//
// u_n is the overlap (m, negative for a gap), F_t the shear force on the first particle, updated
// incrementally by the caller. Fragile contacts lose both adhesions when the tension exceeds a_n or the shear
// exceeds its limit, and have them again only after separating and touching again; contacts that are not
// fragile hold the tension a_n (eq. 1) up to the interaction range. A law knows no history: the caller passes
// it in and keeps what comes out.
#pragma once

namespace loam::engine {
namespace {

template <class T, class Mask>
struct NormalResponse {
    T force;      // F_n (N), compression positive
    Mask active;  // contact exists
};

/// Normal force. `adhesion` = a_n or 0 once broken; `range` = largest gap (m) at which tension acts;
/// `touching`: the contact existed before this step.
template <class T, class Mask>
static inline __attribute__((always_inline)) NormalResponse<T, Mask> linear_cohesive_normal(
    T overlap, T stiffness, T adhesion, T range, Mask touching, bool fragile) {
    T force = stiffness * overlap;
    const Mask within = touching & (-overlap < range) & (adhesion > 0);
    if (fragile) return {force, (overlap > 0) | (within & (-force <= adhesion))};
    force = choose(force < -adhesion, -adhesion, force);
    return {force, (overlap > 0) | within};
}

/// Largest shear force (N) that the contact carries.
template <class T>
static inline __attribute__((always_inline)) T linear_cohesive_shear_limit(T normal_force, T friction,
                                                                           T adhesion) {
    const T limit = normal_force * friction + adhesion;
    return choose(limit > 0, limit, limit * 0);
}

}  // namespace
}  // namespace loam::engine
