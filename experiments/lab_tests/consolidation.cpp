#include "experiments/lab_tests/consolidation.hpp"

namespace loam::experiments {

engine::ServoSummary consolidate_with(engine::Simulation& simulation, const engine::ContactLaw& law,
                                      double stress, double seating_stiffness,
                                      const engine::ServoOptions& servo,
                                      const std::function<bool()>& cancelled) {
    if (seating_stiffness > 0) {
        for (double modulus = seating_stiffness * stress; modulus < law.young_modulus(); modulus *= 4) {
            simulation.set_law(law.with_young_modulus(modulus));
            consolidate(simulation, stress, servo, cancelled);
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
