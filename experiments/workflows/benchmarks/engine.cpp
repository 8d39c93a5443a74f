// loam bench engine: speed of the step on packings at rest under oedometric compression.
#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "engine/kernel/kernel.hpp"
#include "engine/packing.hpp"
#include "engine/simulation.hpp"
#include "experiments/workflows/benchmarks/benchmarks.hpp"

namespace loam::experiments {

int bench_engine(const Settings& settings) {
    nlohmann::json rows = nlohmann::json::array();
    std::string text =
        fmt::format("kernel {}\n{:<16} {:<8} {:>9} {:>14} {:>14}\n", engine::select_kernel().name, "law",
                    "rotation", "particles", "particle-steps", "contact-steps");
    for (const std::uint32_t particles : {500u, 700u, 2000u, 10000u}) {
        engine::PackingOptions options;
        options.particles = particles;
        const engine::Packing packing = engine::make_packing(options).packing;
        for (const bool rotation : {false, true}) {
            engine::SimulationOptions how;
            how.free_rotation = rotation;
            engine::Simulation simulation(packing, engine::LinearCohesive{}, how);
            Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
            gradient(2, 2) = -2e-6 / simulation.time_step();
            simulation.set_velocity_gradient(gradient);
            simulation.advance(200);
            const int steps = static_cast<int>(14'000'000 / particles);
            const auto start = std::chrono::steady_clock::now();
            const double contacts = simulation.advance(steps).contacts;
            const double seconds =
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            const double rate = steps / seconds;
            rows.push_back({{"code", "loam"},
                            {"law", "linear-cohesive"},
                            {"rotation", rotation ? "free" : "blocked"},
                            {"particles", particles},
                            {"threads", 1},
                            {"particle_steps_per_s", rate * particles},
                            {"contact_steps_per_s", rate * contacts},
                            {"ratio", 1.0}});
            text += fmt::format("{:<16} {:<8} {:>9} {:>12.1f} M {:>12.1f} M\n", "linear-cohesive",
                                rotation ? "free" : "blocked", particles, rate * particles / 1e6,
                                rate * contacts / 1e6);
        }
    }
    fmt::print("{}", settings.json ? rows.dump(1) + "\n" : text);
    return 0;
}

}  // namespace loam::experiments
