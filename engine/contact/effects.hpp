// Parameters of the effects on top of a base law. Each is nested in the base law: strength 0, the default, is
// the base law bit for bit.
#pragma once

namespace loam::engine {

/// The effect `rolling_resistance`: an elastic-plastic moment against rolling, k_r = stiffness k_t R_i R_j,
/// of at most friction F_n min(R_i, R_j); no resistance to twisting. Friction 0: no effect.
struct RollingResistance {
    double friction = 0;
    double stiffness = 2;

    void validate() const;  // throws std::invalid_argument naming field, value, constraint
};

/// The effect `adhesion`: every contact holds the tension stress min(R)² and, beside friction, the shear
/// force shear_ratio stress min(R)². Where one of the two is passed, both are lost until the grains part and
/// touch again. On linear-cohesive it adds to the law's own cohesion.
struct Adhesion {
    double stress = 0;  // Pa
    double shear_ratio = 1;

    void validate() const;
};

/// The effect `hertzian_stiffness` of the linear laws: the share of the spring that is Hertz's, beside a
/// linear one. The tangent stiffness is that of the linear law where a contact carries 4 reference_pressure
/// min(R)²: the mean force in a packing under that pressure (see contact/hertzian_stiffness.hpp).
struct HertzianStiffness {
    double share = 0;                 // 0: linear; 1: Hertz
    double reference_pressure = 1e5;  // Pa

    void validate() const;
};

/// The effect `capillarity`: liquid bridges with this suction, whose liquid covers the grains up to the
/// filling angle seen from their centres (see contact/capillarity.hpp).
struct Capillarity {
    double suction = 0;           // Pa
    double filling_angle = 0.35;  // rad

    void validate() const;
};

/// The effect `cementation`: contacts that Simulation::cement_contacts has bonded hold the tension strength
/// min(R)² and, beside friction, the shear force shear_ratio strength min(R)², until one of them is passed.
struct Cementation {
    double strength = 0;  // Pa
    double shear_ratio = 1;

    void validate() const;
};

/// The effect `plastic_contact`: `share` of the overlap stays when a contact is unloaded, along a spring that
/// is 1/(1 - share) times as stiff (see contact/plastic_contact.hpp).
struct PlasticContact {
    double share = 0;

    void validate() const;
};

}  // namespace loam::engine
