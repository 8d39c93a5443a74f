// What a simulation is told of the forces between its particles: a base law with its parameters.
#pragma once

#include <variant>

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

/// A base law, resolved once when a simulation takes it.
struct ContactLaw {
    std::variant<LinearCohesive> base;

    ContactLaw() = default;
    ContactLaw(const LinearCohesive& law) : base(law) {}

    /// The contact modulus of the base law (Pa).
    double young_modulus() const;
    /// The same law with another modulus (Pa).
    ContactLaw with_young_modulus(double modulus) const;
    void validate() const;  // throws std::invalid_argument naming field, value, constraint
};

}  // namespace loam::engine
