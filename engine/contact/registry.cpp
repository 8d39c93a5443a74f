#include "engine/contact/registry.hpp"

#include <algorithm>
#include <array>

namespace loam::engine {
namespace {

constexpr double half_pi = 1.5707963267948966;

constexpr PriorInfo friction_prior{PriorKind::normal, 0.2 * half_pi, 0.1 * half_pi, 0.01 * half_pi,
                                   0.99 * half_pi};

// De Pue et al. (2019), Table 2, with their bounds on nu and phi; the normal priors of log10 are cut at three
// sd, where a run is either rigid or flattened under the first stages.
constexpr std::array linear_cohesive_parameters{
    ParameterInfo{"young_modulus",
                  "E",
                  "Pa",
                  1e4,
                  1e13,
                  {PriorKind::lognormal, 8.5, 0.8, 1.2589254117941673e6, 7.943282347242815e10},
                  "contact modulus: k_n = 2 E R for each particle, two in series",
                  "De Pue et al. 2019, eqs 4 and 6",
                  fitted},
    ParameterInfo{"stiffness_ratio",
                  "k_t/k_n",
                  "1",
                  0.0,
                  2.0,
                  {PriorKind::normal, 0.4, 0.2, 0.01, 0.99},
                  "shear over normal contact stiffness (nu of the paper)",
                  "De Pue et al. 2019, eq. 5",
                  fitted},
    ParameterInfo{"friction_angle", "phi", "rad", 0.0, 1.56, friction_prior,
                  "friction angle between particles", "De Pue et al. 2019, eq. 3", fitted},
    ParameterInfo{"normal_cohesion",
                  "C_n",
                  "Pa",
                  0.0,
                  1e10,
                  {PriorKind::lognormal, 5.0, 1.0, 1e2, 1e8},
                  "tensile limit over the square of the smaller radius",
                  "De Pue et al. 2019, eqs 1 and 7",
                  fitted},
    ParameterInfo{"shear_cohesion",
                  "C_t",
                  "Pa",
                  0.0,
                  1e10,
                  {PriorKind::lognormal, 5.0, 1.0, 1e2, 1e8},
                  "shear strength without normal force over the square of the smaller radius",
                  "De Pue et al. 2019, eqs 3 and 7",
                  fitted},
};

ContactLaw make_linear_cohesive(std::span<const double> v) {
    LinearCohesive law;
    law.young_modulus = v[0];
    law.stiffness_ratio = v[1];
    law.friction_angle = v[2];
    law.normal_cohesion = v[3];
    law.shear_cohesion = v[4];
    return law;
}

constexpr std::string_view grape = "GRAPE (Fraunhofer ITWM), Table 1";

// The paper varies E and mu alone; its typical range of E is 1e5 to 1e9 Pa and its sands lie at 1.1e8.
constexpr std::array linear_damped_parameters{
    ParameterInfo{"young_modulus",
                  "E",
                  "Pa",
                  1e4,
                  1e13,
                  {PriorKind::lognormal, 8.0, 0.8, 1e6, 1e10},
                  "contact modulus: k_n = pi/4 E (R_i + R_j)",
                  grape,
                  fitted},
    ParameterInfo{"friction_angle", "atan mu", "rad", 0.0, 1.56, friction_prior,
                  "friction angle between particles; its tangent is the paper's mu", grape, fitted},
    ParameterInfo{"stiffness_ratio",
                  "k_t/k_n",
                  "1",
                  0.0,
                  2.0,
                  {PriorKind::uniform, 0, 0, 0.1, 1.0},
                  "shear over normal contact stiffness",
                  grape,
                  1 / 1.2},
    ParameterInfo{"normal_damping",
                  "D_N",
                  "1",
                  0.0,
                  1.0,
                  {PriorKind::uniform, 0, 0, 0.0, 1.0},
                  "dashpot beside the normal spring, over the critical one",
                  grape,
                  0.1},
    ParameterInfo{"tangential_damping",
                  "D_T",
                  "1",
                  0.0,
                  1.0,
                  {PriorKind::uniform, 0, 0, 0.0, 1.0},
                  "dashpot beside the shear spring, over the critical one",
                  grape,
                  0.1},
};

ContactLaw make_linear_damped(std::span<const double> v) {
    LinearDamped law;
    law.young_modulus = v[0];
    law.friction_angle = v[1];
    law.stiffness_ratio = v[2];
    law.normal_damping = v[3];
    law.tangential_damping = v[4];
    return law;
}

// Their Table 2 has 70 GPa for the mineral; spheres that stand for rough grains are fitted with far less.
constexpr std::array hertz_mindlin_parameters{
    ParameterInfo{"young_modulus",
                  "E",
                  "Pa",
                  1e4,
                  1e13,
                  {PriorKind::lognormal, 9.0, 0.8, 1e7, 1e12},
                  "Young's modulus of the grains",
                  "Sayakov et al., eq. 2",
                  fitted},
    ParameterInfo{"friction_angle", "atan mu", "rad", 0.0, 1.56, friction_prior,
                  "friction angle between particles", "Sayakov et al., section 2.3", fitted},
    ParameterInfo{"poisson_ratio",
                  "nu",
                  "1",
                  0.0,
                  0.5,
                  {PriorKind::uniform, 0, 0, 0.0, 0.5},
                  "Poisson's ratio of the grains",
                  "Sayakov et al., eqs 2 and 5",
                  0.3},
    ParameterInfo{"restitution",
                  "e",
                  "1",
                  0.0,
                  1.0,
                  {PriorKind::uniform, 0, 0, 0.01, 1.0},
                  "coefficient of restitution of a normal impact, by the dashpots",
                  "Sayakov et al., eqs 3 and 6",
                  0.5},
};

ContactLaw make_hertz_mindlin(std::span<const double> v) {
    HertzMindlin law;
    law.young_modulus = v[0];
    law.friction_angle = v[1];
    law.poisson_ratio = v[2];
    law.restitution = v[3];
    return law;
}

constexpr std::array all_laws{
    LawInfo{"linear-cohesive", "linear springs, Coulomb friction, normal and shear cohesion",
            "De Pue et al. 2019, eqs 1-7 (after Bourrier et al. 2013)", linear_cohesive_parameters,
            make_linear_cohesive},
    LawInfo{"linear-damped", "linear springs with dashpots, Coulomb friction",
            "GRAPE (Fraunhofer ITWM), eqs 1-2 and Table 1", linear_damped_parameters, make_linear_damped},
    LawInfo{"hertz-mindlin", "Hertz's normal force, Mindlin's shear stiffness, dashpots, Coulomb friction",
            "Sayakov et al., eqs 1-6; Elata and Berryman 1996 for changing overlap", hertz_mindlin_parameters,
            make_hertz_mindlin},
};

}  // namespace

std::span<const LawInfo> laws() {
    return all_laws;
}

const LawInfo* find_law(std::string_view name) {
    const auto at = std::ranges::find(all_laws, name, &LawInfo::name);
    return at == all_laws.end() ? nullptr : at;
}

}  // namespace loam::engine
