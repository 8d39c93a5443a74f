#include "engine/contact/effects.hpp"

#include <cmath>

#include "engine/require.hpp"

namespace loam::engine {

void RollingResistance::validate() const {
    require(std::isfinite(friction) && friction >= 0, "rolling_friction", friction, ">= 0");
    require(std::isfinite(stiffness) && stiffness > 0, "rolling_stiffness", stiffness, "positive");
}

void Adhesion::validate() const {
    require(std::isfinite(stress) && stress >= 0, "adhesion", stress, ">= 0 (Pa)");
    require(std::isfinite(shear_ratio) && shear_ratio >= 0, "adhesion_shear_ratio", shear_ratio, ">= 0");
}

void HertzianStiffness::validate() const {
    require(share >= 0 && share <= 1, "hertzian_share", share, "within 0..1");
    require(std::isfinite(reference_pressure) && reference_pressure > 0, "hertzian_reference_pressure",
            reference_pressure, "positive (Pa)");
}

void Capillarity::validate() const {
    require(std::isfinite(suction) && suction >= 0, "suction", suction, ">= 0 (Pa)");
    require(filling_angle >= 0.05 && filling_angle <= 0.7, "filling_angle", filling_angle,
            "within 0.05..0.7 (rad)");
}

void Cementation::validate() const {
    require(std::isfinite(strength) && strength >= 0, "cement_strength", strength, ">= 0 (Pa)");
    require(std::isfinite(shear_ratio) && shear_ratio >= 0, "cement_shear_ratio", shear_ratio, ">= 0");
}

void PlasticContact::validate() const {
    require(share >= 0 && share <= 0.95, "plastic_share", share, "within 0..0.95");
}

}  // namespace loam::engine
