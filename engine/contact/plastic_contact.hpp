// The effect `plastic_contact`: springs that keep a share s of their overlap (Walton and Braun 1986, J.
// Rheol. 30, 949-980; Luding 2008, Granular Matter 10, 235-246, without his cohesion). With the largest
// overlap u_m of the contact so far, the base law acts on
//
//   u = (overlap - s u_m)/(1 - s)
//
// which is the overlap itself while that grows beyond u_m, and falls 1/(1 - s) times as fast when it does
// not: unloading and reloading run along a spring of k/(1 - s) from the permanent overlap s u_m. Of the base
// law's energy U(u_m) at loading the share s is lost and (1 - s) U(u) is stored. A head-on impact keeps
// sqrt(1 - s) of its speed. What a contact remembers ends when the overlap does.
#pragma once

#include "engine/contact/law_numbers.hpp"

namespace loam::engine {
namespace {

template <class T>
struct PlasticOverlap {
    T largest;  // u_m (m)
    T elastic;  // u (m), negative where the grains are apart by their flattening or in tension

    inline __attribute__((always_inline)) PlasticOverlap(const LawNumbers& n, T overlap, T largest_before)
        : largest(choose(overlap > largest_before, overlap, largest_before)) {
        // Exact where the overlap is the largest, whatever the rounding of the quotient.
        elastic =
            choose(overlap < largest, (overlap - n.plastic_share * largest) * n.plastic_stiffening, overlap);
    }
};

}  // namespace
}  // namespace loam::engine
