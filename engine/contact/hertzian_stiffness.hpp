// The effect `hertzian_stiffness`: a linear spring k u and a Hertzian one side by side, with the share s of
// the second:
//
//   dF/du = k ((1 - s) + s q),  F = k u ((1 - s) + 2/3 s q),  U = k u² ((1 - s)/2 + 4/15 s q),
//   q = sqrt(u/u*),  F(u*) = 4 P min(R)²  so that  u* = 4 P min(R)² / (k (1 - s/3))
//
// At the force 4 P min(R)² the tangent is k whatever the share. That is the mean force of a contact in a
// packing of equal spheres at the pressure P where solid fraction times coordination number is pi, as in soil
// (Rumpf 1970: P = solid fraction · coordination number · F / (4 pi R²)). Two springs instead of one with an
// exponent between 1 and 3/2: the same ends, a finite stiffness between, and no power in the inner loop.
#pragma once

#include "engine/contact/law_numbers.hpp"

namespace loam::engine {
namespace {

/// Turns the linear spring of `law` at this overlap (m, >= 0) into both.
template <class T, class Law>
static inline __attribute__((always_inline)) void stiffen_with_force(const LawNumbers& n,
                                                                     const Touch<T>& pair, T overlap,
                                                                     Law& law, T& twice_energy) {
    const double linear = 1 - n.hertzian_share;
    const T q = n.hertzian_share *
                square_root(overlap * law.kn *
                            ((linear + 2.0 / 3.0 * n.hertzian_share) * n.hertzian_scale / pair.area));
    law.force = law.force * (linear + (2.0 / 3.0) * q);
    twice_energy = twice_energy * (linear + (8.0 / 15.0) * q);
    law.kn = law.kn * (linear + q);
    law.kt = law.kt * (linear + q);
}

}  // namespace
}  // namespace loam::engine
