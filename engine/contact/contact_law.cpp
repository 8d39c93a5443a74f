#include "engine/contact/contact_law.hpp"

#include <cmath>
#include <numbers>

#include "engine/require.hpp"

namespace loam::engine {

namespace {

void require_modulus(double young_modulus) {
    require(std::isfinite(young_modulus) && young_modulus > 0, "young_modulus", young_modulus,
            "a positive number (Pa)");
}

void require_friction_angle(double angle) {
    require(angle >= 0 && angle < 0.5 * std::numbers::pi, "friction_angle", angle, "within 0..pi/2 (rad)");
}

void require_stiffness_ratio(double ratio) {
    require(ratio >= 0 && ratio <= 2, "stiffness_ratio", ratio, "within 0..2");
}

}  // namespace

void LinearCohesive::validate() const {
    require_modulus(young_modulus);
    require_stiffness_ratio(stiffness_ratio);
    require_friction_angle(friction_angle);
    require(std::isfinite(normal_cohesion) && normal_cohesion >= 0, "normal_cohesion", normal_cohesion,
            ">= 0 (Pa)");
    require(std::isfinite(shear_cohesion) && shear_cohesion >= 0, "shear_cohesion", shear_cohesion,
            ">= 0 (Pa)");
    require(interaction_range >= 1 && interaction_range <= 2, "interaction_range", interaction_range,
            "within 1..2");
}

void LinearDamped::validate() const {
    require_modulus(young_modulus);
    require_stiffness_ratio(stiffness_ratio);
    require_friction_angle(friction_angle);
    require(normal_damping >= 0 && normal_damping <= 1, "normal_damping", normal_damping, "within 0..1");
    require(tangential_damping >= 0 && tangential_damping <= 1, "tangential_damping", tangential_damping,
            "within 0..1");
}

void HertzMindlin::validate() const {
    require_modulus(young_modulus);
    require_friction_angle(friction_angle);
    require(poisson_ratio > -1 && poisson_ratio <= 0.5, "poisson_ratio", poisson_ratio, "within -1..0.5");
    require(restitution >= 0 && restitution <= 1, "restitution", restitution, "within 0..1");
}

double ContactLaw::young_modulus() const {
    return std::visit([](const auto& law) { return law.young_modulus; }, base);
}

ContactLaw ContactLaw::with_young_modulus(double modulus) const {
    ContactLaw out = *this;
    std::visit([&](auto& law) { law.young_modulus = modulus; }, out.base);
    return out;
}

ContactLaw ContactLaw::of_seating() const {
    ContactLaw out = *this;
    out.cementation.strength = 0;
    out.plastic.share = 0;
    return out;
}

void ContactLaw::validate() const {
    std::visit([](const auto& law) { law.validate(); }, base);
    rolling.validate();
    adhesion.validate();
    hertzian.validate();
    capillarity.validate();
    cementation.validate();
    plastic.validate();
    require(hertzian.share == 0 || !std::holds_alternative<HertzMindlin>(base), "hertzian_share",
            hertzian.share, "0 on the law hertz-mindlin, whose stiffness grows with force by itself");
    const auto* cohesive = std::get_if<LinearCohesive>(&base);
    const bool others =
        hertzian.share > 0 || capillarity.suction > 0 || cementation.strength > 0 || plastic.share > 0;
    require(cohesive == nullptr || cohesive->fragile || !others, "fragile", 0,
            "true where linear-cohesive has one of the effects hertzian_stiffness, capillarity, cementation, "
            "plastic_contact");
}

}  // namespace loam::engine
