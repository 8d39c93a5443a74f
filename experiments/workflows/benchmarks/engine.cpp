// loam bench engine: speed of the step under oedometric compression, on packings at rest and on packings that
// fly apart because their contacts were stiffened at once.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/kernel/kernel.hpp"
#include "engine/loading.hpp"
#include "engine/packing.hpp"
#include "engine/simulation.hpp"
#include "experiments/workflows/benchmarks/benchmarks.hpp"

namespace loam::experiments {
namespace {

struct Speed {
    double steps_per_s, contacts;
    engine::StepTimes share;  // of the step's time, 0..1
};

/// Stiffens the contacts by steps at the stress of the packing, as an oedometer test seats its specimen.
void seat(engine::Simulation& simulation, const engine::PackingOptions& packing) {
    const engine::ContactLaw law;
    engine::ServoOptions servo;
    servo.max_steps = 20'000;
    for (double modulus = packing.stiffness_ratio * packing.stress; modulus < law.young_modulus();
         modulus *= 4) {
        simulation.set_law(law.with_young_modulus(modulus));
        engine::consolidate(simulation, packing.stress, servo);
    }
    simulation.set_law(law);
    engine::consolidate(simulation, packing.stress, servo);
}

Speed measure_speed(engine::Simulation& simulation, double strain_per_step, int steps) {
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    gradient(2, 2) = -strain_per_step / simulation.time_step();
    simulation.set_velocity_gradient(gradient);
    simulation.advance(200);
    const auto start = std::chrono::steady_clock::now();
    const double contacts = simulation.advance(steps).contacts;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    engine::StepTimes times;
    simulation.time_steps(&times);
    simulation.advance(steps / 4);
    simulation.time_steps(nullptr);
    const double total = times.neighbours + times.contacts + times.integration;
    return {steps / seconds,
            contacts,
            {times.neighbours / total, times.contacts / total, times.integration / total}};
}

}  // namespace

int bench_engine(const Settings& settings) {
    nlohmann::json rows = nlohmann::json::array();
    std::string text =
        fmt::format("kernel {}\n{:<16} {:<8} {:<8} {:>9} {:>14} {:>14} {:>10} {:>10} {:>11}\n",
                    engine::select_kernel().name, "law", "state", "rotation", "particles", "particle-steps",
                    "contact-steps", "neighbours", "contacts", "integration");
    for (const std::uint32_t particles : {500u, 700u, 2000u, 10000u, 50000u}) {
        engine::PackingOptions options;
        options.particles = particles;
        const engine::Packing packing = engine::make_packing(options).packing;
        for (const bool at_rest : {true, false})
            for (const bool rotation : {false, true}) {
                engine::SimulationOptions how;
                how.free_rotation = rotation;
                engine::Simulation simulation(packing, engine::ContactLaw{}, how);
                if (at_rest) seat(simulation, options);
                const Speed speed = measure_speed(simulation, at_rest ? 6e-7 : 2e-6,
                                                  std::max(400, static_cast<int>(14'000'000 / particles)));
                const char *state = at_rest ? "at rest" : "flying", *spins = rotation ? "free" : "blocked";
                rows.push_back({{"code", "loam"},
                                {"law", "linear-cohesive"},
                                {"state", state},
                                {"rotation", spins},
                                {"particles", particles},
                                {"threads", 1},
                                {"particle_steps_per_s", speed.steps_per_s * particles},
                                {"contact_steps_per_s", speed.steps_per_s * speed.contacts},
                                {"share_neighbours", speed.share.neighbours},
                                {"share_contacts", speed.share.contacts},
                                {"share_integration", speed.share.integration},
                                {"ratio", 1.0}});
                text += fmt::format(
                    "{:<16} {:<8} {:<8} {:>9} {:>12.1f} M {:>12.1f} M {:>8.0f} % {:>8.0f} % {:>9.0f} %\n",
                    "linear-cohesive", state, spins, particles, speed.steps_per_s * particles / 1e6,
                    speed.steps_per_s * speed.contacts / 1e6, 100 * speed.share.neighbours,
                    100 * speed.share.contacts, 100 * speed.share.integration);
            }
    }
    fmt::print("{}", settings.json ? rows.dump(1) + "\n" : text);
    return 0;
}

}  // namespace loam::experiments
