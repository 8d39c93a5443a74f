// What the benchmark of the engine measures: laws with their parameters on packings at rest, or flying apart.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "engine/simulation.hpp"
#include "experiments/workflows/benchmarks/other_codes.hpp"

namespace loam::experiments {

/// A law of this engine, made of the parameters that it shares with other codes' laws.
struct BenchLaw {
    std::string_view name;  // as engine::laws() has it
    engine::ContactLaw (*law)(const SharedParameters&);
};

/// The laws that are measured. A further law is one line.
std::span<const BenchLaw> bench_laws();

/// The law of that name, or nullptr.
const BenchLaw* find_bench_law(std::string_view name);

/// A dense packing of that many particles, of radii that differ by 30 %.
engine::Packing bench_packing(std::uint32_t particles);

/// The packing under the law, brought to rest under a stress at which it has about 2.4 contacts a particle.
engine::Packing seated(const engine::Packing& packing, const engine::ContactLaw& law, bool free_rotation);

/// Options of the simulations that are measured.
engine::SimulationOptions bench_options(bool free_rotation, int threads = 1);

inline constexpr double strain_per_step = 6e-7;  // slow: neighbours stay what they are for hundreds of steps

/// Sets the simulation going: compression along z at that rate.
void compress(engine::Simulation& simulation, double strain_a_step);

/// Advances by that many steps and says the processor time of this thread (s) and the contacts at the end.
Timing timed_steps(engine::Simulation& simulation, int steps);
/// The same with the time that passes, which is what several threads are for.
Timing timed_steps_of_all_threads(engine::Simulation& simulation, int steps);

}  // namespace loam::experiments
