#include "experiments/workflows/benchmarks/engine_work.hpp"

#include <array>
#include <ctime>

#include "engine/loading.hpp"

namespace loam::experiments {
namespace {

constexpr double stress = 4e5;  // Pa

engine::ContactLaw linear_cohesive(const SharedParameters& shared) {
    engine::LinearCohesive law;
    law.young_modulus = shared.young_modulus;
    law.stiffness_ratio = shared.stiffness_ratio;
    law.friction_angle = shared.friction_angle;
    law.normal_cohesion = law.shear_cohesion = shared.cohesion;
    return law;
}

constexpr std::array table{BenchLaw{"linear-cohesive", linear_cohesive}};

double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

std::span<const BenchLaw> bench_laws() {
    return table;
}

const BenchLaw* find_bench_law(std::string_view name) {
    for (const BenchLaw& entry : table)
        if (entry.name == name) return &entry;
    return nullptr;
}

engine::Packing bench_packing(std::uint32_t particles) {
    engine::PackingOptions options;
    options.particles = particles;
    options.target_porosity = 0.42;
    return engine::make_packing(options).packing;
}

engine::SimulationOptions bench_options(bool free_rotation) {
    engine::SimulationOptions options;
    options.free_rotation = free_rotation;
    return options;
}

engine::Packing seated(const engine::Packing& packing, const engine::ContactLaw& law, bool free_rotation) {
    engine::Simulation simulation(packing, law, bench_options(free_rotation));
    engine::ServoOptions servo;
    servo.max_steps = 20'000;
    // Stiffened by steps, as an oedometer test seats its specimen: at once it would fly apart.
    const engine::PackingOptions made;
    for (double modulus = made.stiffness_ratio * made.stress; modulus < law.young_modulus(); modulus *= 4) {
        simulation.set_law(law.with_young_modulus(modulus));
        engine::consolidate(simulation, made.stress, servo);
    }
    simulation.set_law(law);
    engine::consolidate(simulation, stress, servo);
    return simulation.packing();
}

void compress(engine::Simulation& simulation, double strain_a_step) {
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    gradient(2, 2) = -strain_a_step / simulation.time_step();
    simulation.set_velocity_gradient(gradient);
}

Timing timed_steps(engine::Simulation& simulation, int steps) {
    const double start = processor_seconds();
    const double contacts = simulation.advance(steps).contacts;
    return {processor_seconds() - start, contacts};
}

}  // namespace loam::experiments
