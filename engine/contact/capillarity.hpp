// The effect `capillarity`: liquid bridges between wetted grains (Jiang and Yu 2006, section 3.2). At a
// contact the attraction is Fisher's (1926, J. Agric. Sci. 16, 492-505), of the suction s over the neck and
// of the surface tension T around it; with the filling angle a seen from the grain's centre and the contact
// angle 0 the meniscus has the radii r1 = R (sec a - 1) and r2 = R (1 + tan a - sec a):
//
//   F_c = pi r2² s + 2 pi r2 T,  s = T (1/r1 - 1/r2)  so that  F_c = pi s r2² (r2 + r1)/(r2 - r1)
//
// Across a gap D it falls as F_c (1 - D/sqrt(D² + b²)), b² = 2 V/(pi R) (Pitois, Moucheront and Chateau 2000,
// J. Colloid Interface Sci. 231, 26-31), up to the rupture at D = V^(1/3) (Lian, Thornton and Adams 1993, J.
// Colloid Interface Sci. 161, 138-147), for the liquid's volume V = 2 pi R³ (sec a - 1)² (1 - (pi/2 - a) tan
// a) (Fisher). R = 2 R_i R_j/(R_i + R_j) (Derjaguin). A bridge forms where grains touch and lasts to the
// rupture. The filling angle is the same at all contacts, in place of the surface tension: then the law has
// no length of its own, and grains may be of any scale.
#pragma once

#include "engine/contact/law_numbers.hpp"

namespace loam::engine {
namespace {

/// The bridge of a pair at an overlap (negative: a gap), whether there is one or not.
template <class T>
struct LiquidBridge {
    T pull;          // N, attraction
    T twice_energy;  // J, zero where the grains just touch
    T reach;         // gap of rupture (m)

    inline __attribute__((always_inline)) LiquidBridge(const LawNumbers& n, const Touch<T>& pair) {
        const T zero = pair.overlap * 0.0, radius = 2.0 * pair.reduced_radius;
        const T gap = choose(pair.overlap < zero, -pair.overlap, zero);
        const T pressed = choose(pair.overlap > zero, pair.overlap, zero);
        const T b = n.bridge_length * radius, to_neck = square_root(gap * gap + b * b);
        const T at_contact = n.bridge_force * radius * radius;
        pull = at_contact * (1.0 - gap / to_neck);
        twice_energy = 2.0 * at_contact * (gap + b - to_neck - pressed);
        reach = n.bridge_reach * radius;
    }
};

}  // namespace
}  // namespace loam::engine
