#include "experiments/workflows/benchmarks/engine_work.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <numbers>
#include <numeric>
#include <tuple>
#include <vector>

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

/// Share of the critical damping that gives this restitution.
double damping_share(double restitution) {
    const double loss = -std::log(restitution);
    return loss / std::hypot(std::numbers::pi, loss);
}

engine::ContactLaw linear_damped(const SharedParameters& shared) {
    engine::LinearDamped law;
    law.young_modulus =
        2 / std::numbers::pi * shared.young_modulus;  // the same springs between equal spheres
    law.stiffness_ratio = shared.stiffness_ratio;
    law.friction_angle = shared.friction_angle;
    law.normal_damping = law.tangential_damping = damping_share(shared.restitution);
    return law;
}

engine::ContactLaw hertz_mindlin(const SharedParameters& shared) {
    engine::HertzMindlin law;
    law.young_modulus = shared.young_modulus;
    law.poisson_ratio = shared.poisson_ratio;
    law.friction_angle = shared.friction_angle;
    law.restitution = shared.restitution;
    return law;
}

constexpr std::array table{BenchLaw{"linear-cohesive", linear_cohesive},
                           BenchLaw{"linear-damped", linear_damped},
                           BenchLaw{"hertz-mindlin", hertz_mindlin}};

/// The particles in the order of layers, rows and blocks of a few diameters, so that no code is slowed by an
/// order that it does not mend itself.
engine::Packing in_order_of_place(const engine::Packing& packing) {
    const double block = 4 * packing.radii.mean();
    std::vector<Eigen::Index> order(static_cast<std::size_t>(packing.radii.size()));
    std::iota(order.begin(), order.end(), 0);
    const auto place = [&](Eigen::Index particle) {
        const Eigen::Vector3d x = (packing.centres.col(particle) / block).array().floor();
        return std::tuple(x[2], x[1], x[0]);
    };
    std::ranges::stable_sort(order, {}, place);
    engine::Packing ordered = packing;
    for (std::size_t k = 0; k < order.size(); ++k) {
        const auto at = static_cast<Eigen::Index>(k);
        ordered.centres.col(at) = packing.centres.col(order[k]);
        ordered.radii[at] = packing.radii[order[k]];
    }
    return ordered;
}

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
    return in_order_of_place(engine::make_packing(options).packing);
}

engine::SimulationOptions bench_options(bool free_rotation, int threads) {
    engine::SimulationOptions options;
    options.free_rotation = free_rotation;
    options.threads = threads;
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

Timing timed_steps_of_all_threads(engine::Simulation& simulation, int steps) {
    const auto start = std::chrono::steady_clock::now();
    const double contacts = simulation.advance(steps).contacts;
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), contacts};
}

}  // namespace loam::experiments
