// How virtual tests bring a packing to rest under their first stress, with the law of the test.
#pragma once

#include <functional>

#include "engine/loading.hpp"
#include "engine/simulation.hpp"

namespace loam::experiments {

/// Brings the packing to rest at an isotropic stress (Pa) with that law. With a positive `seating_stiffness`
/// it does so first with a modulus of at most so many times the stress and stiffens it in steps: stiffening
/// scales all forces at once, and small factors let the packing expand without coming apart. `cancelled` is
/// polled and makes it throw std::runtime_error.
engine::ServoSummary consolidate_with(engine::Simulation& simulation, const engine::ContactLaw& law,
                                      double stress, double seating_stiffness,
                                      const engine::ServoOptions& servo,
                                      const std::function<bool()>& cancelled);

/// Makes the specimen that has been seated with law.of_seating() that of the test: its contacts are cemented
/// now, and from now on a part of what they are pressed together stays, where the law has these effects.
void begin_test(engine::Simulation& simulation, const engine::ContactLaw& law);

}  // namespace loam::experiments
