#include "engine/contact/registry.hpp"

#include <array>

namespace loam::engine {
namespace {

constexpr double half_pi = 1.5707963267948966;

// De Pue et al. (2019), Table 2, with their bounds on nu and phi; the normal priors of log10 are cut at three sd,
// where a run is either rigid or flattened under the first stages.
constexpr std::array linear_cohesive_parameters{
    ParameterInfo{"young_modulus", "E", "Pa", 1e4, 1e13,
                  {PriorKind::lognormal, 8.5, 0.8, 1.2589254117941673e6, 7.943282347242815e10},
                  "contact modulus: k_n = 2 E R for each particle, two in series", "De Pue et al. 2019, eqs 4 and 6"},
    ParameterInfo{"stiffness_ratio", "k_t/k_n", "1", 0.0, 2.0, {PriorKind::normal, 0.4, 0.2, 0.01, 0.99},
                  "shear over normal contact stiffness (nu of the paper)", "De Pue et al. 2019, eq. 5"},
    ParameterInfo{"friction_angle", "phi", "rad", 0.0, 1.56,
                  {PriorKind::normal, 0.2 * half_pi, 0.1 * half_pi, 0.01 * half_pi, 0.99 * half_pi},
                  "friction angle between particles", "De Pue et al. 2019, eq. 3"},
    ParameterInfo{"normal_cohesion", "C_n", "Pa", 0.0, 1e10, {PriorKind::lognormal, 5.0, 1.0, 1e2, 1e8},
                  "tensile limit over the square of the smaller radius", "De Pue et al. 2019, eqs 1 and 7"},
    ParameterInfo{"shear_cohesion", "C_t", "Pa", 0.0, 1e10, {PriorKind::lognormal, 5.0, 1.0, 1e2, 1e8},
                  "shear strength without normal force over the square of the smaller radius",
                  "De Pue et al. 2019, eqs 3 and 7"},
};

constexpr std::array all_laws{
    LawInfo{"linear-cohesive", "linear springs, Coulomb friction, normal and shear cohesion",
            "De Pue et al. 2019, eqs 1-7 (after Bourrier et al. 2013)", linear_cohesive_parameters},
};

}  // namespace

std::span<const LawInfo> laws() { return all_laws; }

const LawInfo* find_law(std::string_view name) {
    for (const LawInfo& law : all_laws)
        if (law.name == name) return &law;
    return nullptr;
}

}  // namespace loam::engine
