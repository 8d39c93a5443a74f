// What the contact loop is told of a law, as plain numbers (SI): resolved once, when a simulation takes the
// law. Shared with code that is compiled for other instruction sets, so nothing here has code.
#pragma once

namespace loam::engine {

/// Which of these a law uses, its header says.
struct LawNumbers {
    double normal_modulus;   // Pa
    double shear_modulus;    // Pa
    double stiffness_ratio;  // k_t / k_n
    double friction_coefficient;
    double normal_cohesion, shear_cohesion;     // Pa
    double tension_range;                       // gap over R_i + R_j up to which tension can act
    double normal_damping, tangential_damping;  // 2 × share of the critical damping
    double mass_of_unit_sphere;                 // kg: 4/3 pi × grain density
    double rolling_friction;                    // moment limit over F_n min(R_i, R_j)
    double rolling_stiffness;                   // k_r / (k_t R_i R_j)
    // Effects, with which contacts go through a loop of their own (contact/with_effects.hpp).
    double cement_tension, cement_shear;       // Pa: over min(R)²
    double hertzian_share;                     // of the spring
    double hertzian_scale;                     // 1/(4 reference pressure) (1/Pa)
    double plastic_share, plastic_stiffening;  // s and 1/(1 - s)
    double bridge_force;                 // Pa: attraction at contact over R², R = 2 R_i R_j/(R_i + R_j)
    double bridge_length, bridge_reach;  // b and the gap of rupture over R
    bool fragile;                        // cohesion is lost for good when its limit is passed
};

/// A pair of spheres as a law sees it; T is a vector of doubles or one double.
template <class T>
struct Touch {
    T overlap;            // m, negative for a gap
    T radius_sum;         // R_i + R_j (m)
    T radius_difference;  // R_j - R_i (m)
    T reduced_radius;     // R_i R_j / (R_i + R_j) (m)
    T area;               // min(R_i, R_j)² (m²)
};

/// Bond states of a pair; kept as doubles because the contact loop blends them with forces. A law may keep
/// another positive number in their place while the spheres touch.
inline constexpr double bond_none = 0.0;      // apart
inline constexpr double bond_broken = 1.0;    // touching, cohesion lost
inline constexpr double bond_cohesive = 2.0;  // touching, cohesion active (also where the cohesion is zero)
inline constexpr double bond_apart = 3.0;     // with effects: apart, with a liquid bridge or a flattening

}  // namespace loam::engine
