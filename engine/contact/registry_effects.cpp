// The table of effects (registry.hpp).
#include <algorithm>
#include <array>

#include "engine/contact/registry.hpp"

namespace loam::engine {
namespace {

constexpr std::array rolling_resistance_parameters{
    ParameterInfo{"rolling_friction",
                  "eta",
                  "1",
                  0.0,
                  2.0,
                  {PriorKind::uniform, 0, 0, 0.0, 0.5},
                  "largest moment over normal force and smaller radius",
                  "Iwashita and Oda 1998; Ai et al. 2011",
                  fitted},
    ParameterInfo{"rolling_stiffness",
                  "k_r/(k_t R_i R_j)",
                  "1",
                  1e-3,
                  100.0,
                  {PriorKind::uniform, 0, 0, 0.5, 4.0},
                  "elastic stiffness of the moment",
                  "Ai et al. 2011; 2 as in YADE's cohesive-frictional law",
                  2.0},
};

void add_rolling_resistance(ContactLaw& law, std::span<const double> v) {
    law.rolling = {v[0], v[1]};
}

constexpr std::array adhesion_parameters{
    ParameterInfo{"adhesion",
                  "A",
                  "Pa",
                  0.0,
                  1e10,
                  {PriorKind::lognormal, 4.5, 1.0, 1e2, 1e8},
                  "tensile limit of a contact over the square of the smaller radius",
                  "as the cohesion of De Pue et al. 2019, eqs 1 and 7",
                  fitted},
    ParameterInfo{"adhesion_shear_ratio",
                  "A_t/A",
                  "1",
                  0.0,
                  10.0,
                  {PriorKind::uniform, 0, 0, 0.0, 2.0},
                  "shear strength without normal force over the tensile limit",
                  "as the cohesion of De Pue et al. 2019, eqs 3 and 7",
                  1.0},
};

void add_adhesion(ContactLaw& law, std::span<const double> v) {
    law.adhesion = {v[0], v[1]};
}

constexpr std::array hertzian_stiffness_parameters{
    ParameterInfo{"hertzian_share",
                  "s",
                  "1",
                  0.0,
                  1.0,
                  {PriorKind::uniform, 0, 0, 0.0, 1.0},
                  "share of the contact spring that is Hertz's: 0 linear, 1 power 3/2",
                  "Hertz 1882, beside the law's own spring",
                  fitted},
    ParameterInfo{
        "hertzian_reference_pressure",
        "P",
        "Pa",
        1.0,
        1e9,
        {PriorKind::loguniform, 0, 0, 1e4, 1e6},
        "pressure at which the mean stiffness is that of the linear law, for contacts that carry 4 P "
        "times the square of the smaller radius",
        "Rumpf 1970, for solid fraction times coordination number pi",
        1e5},
};

void add_hertzian_stiffness(ContactLaw& law, std::span<const double> v) {
    law.hertzian = {v[0], v[1]};
}

constexpr std::string_view jiang_yu = "Jiang and Yu 2006, section 3.2; Fisher 1926";

constexpr std::array capillarity_parameters{
    ParameterInfo{"suction",
                  "s",
                  "Pa",
                  0.0,
                  1e9,
                  {PriorKind::lognormal, 4.7, 0.7, 1e3, 1e7},
                  "pressure of the air over that of the water in the liquid bridges",
                  jiang_yu,
                  fitted},
    ParameterInfo{
        "filling_angle",
        "alpha",
        "rad",
        0.05,
        0.7,
        {PriorKind::uniform, 0, 0, 0.1, 0.6},
        "half of the angle under which a bridge is seen from the grain's centre; with the suction it "
        "gives the surface tension over the radius, and the range of the force",
        jiang_yu,
        0.35},
};

void add_capillarity(ContactLaw& law, std::span<const double> v) {
    law.capillarity = {v[0], v[1]};
}

constexpr std::array cementation_parameters{
    ParameterInfo{"cement_strength",
                  "B",
                  "Pa",
                  0.0,
                  1e10,
                  {PriorKind::lognormal, 5.5, 0.8, 1e3, 1e8},
                  "tensile strength of a bond over the square of the smaller radius",
                  "Jiang and Yu 2006, section 3.3",
                  fitted},
    ParameterInfo{"cement_shear_ratio",
                  "B_t/B",
                  "1",
                  0.0,
                  10.0,
                  {PriorKind::uniform, 0, 0, 0.0, 2.0},
                  "shear strength of a bond, beside friction, over its tensile strength",
                  "Jiang and Yu 2006, section 3.3",
                  1.0},
};

void add_cementation(ContactLaw& law, std::span<const double> v) {
    law.cementation = {v[0], v[1]};
}

constexpr std::array plastic_contact_parameters{
    ParameterInfo{"plastic_share",
                  "1 - k/k_u",
                  "1",
                  0.0,
                  0.95,
                  {PriorKind::uniform, 0, 0, 0.0, 0.5},
                  "share of the largest overlap that is permanent; unloading is 1/(1 - share) times as stiff",
                  "Walton and Braun 1986; Luding 2008",
                  fitted},
};

void add_plastic_contact(ContactLaw& law, std::span<const double> v) {
    law.plastic = {v[0]};
}

constexpr std::array<std::string_view, 2> linear_laws{"linear-cohesive", "linear-damped"};

constexpr std::array all_effects{
    EffectInfo{"rolling_resistance",
               "elastic-plastic moment against rolling; twisting stays free",
               "Iwashita and Oda 1998; Ai et al. 2011, model C",
               rolling_resistance_parameters,
               3,
               true,
               false,
               {},
               add_rolling_resistance},
    EffectInfo{"adhesion",
               "normal and shear cohesion of every contact, lost when passed and renewed on touching again",
               "as in De Pue et al. 2019, on every law",
               adhesion_parameters,
               3,
               false,
               false,
               {},
               add_adhesion},
    EffectInfo{"capillarity",
               "liquid bridges: an attraction that falls with the gap to rupture and forms anew on touching",
               "Jiang and Yu 2006, section 3.2; Pitois et al. 2000; Lian et al. 1993",
               capillarity_parameters,
               3,
               false,
               true,
               {},
               add_capillarity},
    EffectInfo{"cementation",
               "bonds on the contacts of the seated specimen, brittle in tension and shear, never healing",
               "Jiang and Yu 2006, section 3.3",
               cementation_parameters,
               3,
               false,
               true,
               {},
               add_cementation},
    EffectInfo{"hertzian_stiffness",
               "contact stiffness that grows with the force, the same at a reference pressure",
               "Hertz 1882; Rumpf 1970", hertzian_stiffness_parameters, 3, false, true, linear_laws,
               add_hertzian_stiffness},
    EffectInfo{"plastic_contact",
               "hysteretic spring: unloading is stiffer and a part of the overlap stays, from the seated "
               "specimen on",
               "Walton and Braun 1986; Luding 2008",
               plastic_contact_parameters,
               3,
               false,
               true,
               {},
               add_plastic_contact},
};

}  // namespace

bool EffectInfo::goes_with(std::string_view law) const {
    return laws.empty() || std::ranges::find(laws, law) != laws.end();
}

std::span<const EffectInfo> effects() {
    return all_effects;
}

const EffectInfo* find_effect(std::string_view name) {
    const auto at = std::ranges::find(all_effects, name, &EffectInfo::name);
    return at == all_effects.end() ? nullptr : at;
}

}  // namespace loam::engine
