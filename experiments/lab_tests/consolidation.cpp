#include "experiments/lab_tests/consolidation.hpp"

#include <algorithm>

namespace loam::experiments {
namespace {

// Larger factors, or less rest, and the packing comes apart; both then take more steps in all (measured for
// moduli of 1e8 to 4e9 Pa at 2 kPa, friction 0.15 to 0.6 rad, with and without cohesion).
constexpr double stiffening = 3, rest_on_the_way = 0.02;

}  // namespace

engine::ServoSummary consolidate_with(engine::Simulation& simulation, const engine::ContactLaw& law,
                                      double stress, double seating_stiffness,
                                      const engine::ServoOptions& servo,
                                      const std::function<bool()>& cancelled) {
    if (seating_stiffness > 0) {
        engine::ServoOptions on_the_way = servo;
        on_the_way.stress_tolerance = std::max(servo.stress_tolerance, rest_on_the_way);
        on_the_way.unbalanced_ratio = std::max(servo.unbalanced_ratio, rest_on_the_way);
        for (double modulus = seating_stiffness * stress; modulus < law.young_modulus();
             modulus *= stiffening) {
            simulation.set_law(law.with_young_modulus(modulus));
            consolidate(simulation, stress, on_the_way, cancelled);
        }
    }
    simulation.set_law(law);
    return consolidate(simulation, stress, servo, cancelled);
}

void begin_test(engine::Simulation& simulation, const engine::ContactLaw& law) {
    simulation.set_law(law);
    simulation.cement_contacts();
}

}  // namespace loam::experiments
