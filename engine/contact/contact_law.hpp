// What a simulation is told of the forces between its particles: a base law and the effects on top of it,
// with their parameters.
#pragma once

#include <variant>

#include "engine/contact/effects.hpp"

namespace loam::engine {

/// Parameters of the law `linear-cohesive` (De Pue et al. 2019, eqs 1-7; see contact/linear_cohesive.hpp).
struct LinearCohesive {
    double young_modulus = 3.1622776601683795e8;  // E (Pa): k_n = 2 E R for each particle, two in series
    double stiffness_ratio = 0.4;                 // k_t / k_n
    double friction_angle = 0.31;                 // rad
    double normal_cohesion = 1e5;                 // C_n (Pa)
    double shear_cohesion = 1e5;                  // C_t (Pa)
    bool fragile = true;             // cohesion is lost when its limit is passed, renewed on touching again
    double interaction_range = 1.5;  // distance over R_i + R_j up to which tension can act

    void validate() const;  // throws std::invalid_argument naming field, value, constraint
};

/// Parameters of the law `linear-damped` (GRAPE, its Table 1; see contact/linear_damped.hpp).
struct LinearDamped {
    double young_modulus = 1.1e8;        // E (Pa): k_n = pi/4 E (R_i + R_j)
    double stiffness_ratio = 1.0 / 1.2;  // k_t / k_n
    double friction_angle = 0.1684;      // rad; its tangent is the paper's mu
    double normal_damping = 0.1;         // D_N, of the critical damping
    double tangential_damping = 0.1;     // D_T

    void validate() const;
};

/// Parameters of the law `hertz-mindlin` (Sayakov et al., eqs 1-6; see contact/hertz_mindlin.hpp).
struct HertzMindlin {
    double young_modulus = 5e8;  // E of the grains (Pa)
    double poisson_ratio = 0.3;
    double friction_angle = 0.46;  // rad
    double restitution = 0.5;      // of a normal impact, by the dashpots

    void validate() const;
};

/// A base law with its effects, resolved once when a simulation takes it.
struct ContactLaw {
    std::variant<LinearCohesive, LinearDamped, HertzMindlin> base;
    RollingResistance rolling;  // needs free rotation
    Adhesion adhesion;
    HertzianStiffness hertzian;  // only on linear laws
    Capillarity capillarity;
    Cementation cementation;
    PlasticContact plastic;

    ContactLaw() = default;
    ContactLaw(const LinearCohesive& law) : base(law) {}
    ContactLaw(const LinearDamped& law) : base(law) {}
    ContactLaw(const HertzMindlin& law) : base(law) {}

    /// The contact modulus of the base law (Pa).
    double young_modulus() const;
    /// The same law with another modulus (Pa).
    ContactLaw with_young_modulus(double modulus) const;
    /// The same law without the effects that begin with a test, on a specimen that has been seated:
    /// cementation and plastic_contact.
    ContactLaw of_seating() const;
    void validate() const;  // throws std::invalid_argument naming field, value, constraint
};

}  // namespace loam::engine
