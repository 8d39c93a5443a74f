#include "engine/contact/contact_law.hpp"

#include <cmath>
#include <numbers>

#include "engine/require.hpp"

namespace loam::engine {

void LinearCohesive::validate() const {
    require(std::isfinite(young_modulus) && young_modulus > 0, "young_modulus", young_modulus,
            "a positive number (Pa)");
    require(stiffness_ratio >= 0 && stiffness_ratio <= 2, "stiffness_ratio", stiffness_ratio, "within 0..2");
    require(friction_angle >= 0 && friction_angle < 0.5 * std::numbers::pi, "friction_angle", friction_angle,
            "within 0..pi/2 (rad)");
    require(std::isfinite(normal_cohesion) && normal_cohesion >= 0, "normal_cohesion", normal_cohesion,
            ">= 0 (Pa)");
    require(std::isfinite(shear_cohesion) && shear_cohesion >= 0, "shear_cohesion", shear_cohesion,
            ">= 0 (Pa)");
    require(interaction_range >= 1 && interaction_range <= 2, "interaction_range", interaction_range,
            "within 1..2");
}

double ContactLaw::young_modulus() const {
    return std::visit([](const auto& law) { return law.young_modulus; }, base);
}

ContactLaw ContactLaw::with_young_modulus(double modulus) const {
    ContactLaw out = *this;
    std::visit([&](auto& law) { law.young_modulus = modulus; }, out.base);
    return out;
}

void ContactLaw::validate() const {
    std::visit([](const auto& law) { law.validate(); }, base);
}

}  // namespace loam::engine
