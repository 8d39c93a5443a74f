// loam bench engine: speed of the step under oedometric compression, on packings at rest and on packings that
// fly apart because their contacts were stiffened at once; with --against, beside other codes.
#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/kernel/kernel.hpp"
#include "experiments/workflows/benchmarks/against.hpp"
#include "experiments/workflows/benchmarks/benchmarks.hpp"
#include "experiments/workflows/benchmarks/engine_work.hpp"

namespace loam::experiments {
namespace {

constexpr double flying_strain_per_step = 2e-6;

struct Result {
    SpeedRow row;
    std::string_view state;   // at rest | flying
    engine::StepTimes share;  // of the step's time, 0..1
};

/// The steps' time is measured without the clocks between their parts, the shares with them.
Result measure(engine::Simulation& simulation, SpeedRow row, bool at_rest) {
    const int steps = std::max(400, static_cast<int>(14'000'000 / row.particles));
    compress(simulation, at_rest ? strain_per_step : flying_strain_per_step);
    simulation.advance(200);
    const Timing timing =
        row.threads == 1 ? timed_steps(simulation, steps) : timed_steps_of_all_threads(simulation, steps);
    engine::StepTimes times;
    simulation.time_steps(&times);
    simulation.advance(steps / 4);
    simulation.time_steps(nullptr);
    const double total = times.neighbours + times.contacts + times.integration;
    row.particle_steps_per_s = steps / timing.seconds * row.particles;
    row.contact_steps_per_s = steps / timing.seconds * timing.contacts;
    return {row,
            at_rest ? "at rest" : "flying",
            {times.neighbours / total, times.contacts / total, times.integration / total}};
}

nlohmann::json to_json(const Result& result) {
    nlohmann::json json = to_json(result.row);
    json["state"] = result.state;
    json["share_neighbours"] = result.share.neighbours;
    json["share_contacts"] = result.share.contacts;
    json["share_integration"] = result.share.integration;
    return json;
}

std::string line_of(const Result& result) {
    const SpeedRow& row = result.row;
    return fmt::format(
        "{:<16} {:<8} {:<8} {:>9} {:>7} {:>12.1f} M {:>12.1f} M {:>8.0f} % {:>8.0f} % {:>9.0f} %\n", row.law,
        result.state, row.rotation, row.particles, row.threads, row.particle_steps_per_s / 1e6,
        row.contact_steps_per_s / 1e6, 100 * result.share.neighbours, 100 * result.share.contacts,
        100 * result.share.integration);
}

/// On one core, and where the packing is large enough for threads on all.
std::vector<Result> measure_law(const BenchLaw& entry, const engine::Packing& packing, bool at_rest,
                                bool free) {
    const engine::ContactLaw law = entry.law({});
    const auto particles = static_cast<std::uint32_t>(packing.radii.size());
    const engine::Packing start = at_rest ? seated(packing, law, free) : packing;
    const int all = engine::slab_count(particles, packing.cell, 2 * packing.radii.maxCoeff()) == 1
                        ? 1
                        : omp_get_num_procs();
    std::vector<Result> results;
    for (int threads = 1; threads <= all; threads += std::max(1, all - 1)) {
        engine::Simulation simulation(start, law, bench_options(free, threads));
        results.push_back(measure(simulation,
                                  {.code = "loam",
                                   .law = entry.name,
                                   .rotation = free ? "free" : "blocked",
                                   .particles = particles,
                                   .threads = threads,
                                   .its_law = entry.name},
                                  at_rest));
    }
    return results;
}

std::vector<Result> measure_laws(std::uint32_t particles) {
    const engine::Packing packing = bench_packing(particles);
    std::vector<Result> results;
    for (const BenchLaw& entry : bench_laws())
        for (const bool at_rest : {true, false})
            for (const bool free : {false, true})
                for (Result& result : measure_law(entry, packing, at_rest, free))
                    results.push_back(std::move(result));
    return results;
}

}  // namespace

int bench_engine(const Settings& settings) {
    if (!settings.against.empty()) return bench_engine_against(settings);
    nlohmann::json rows = nlohmann::json::array();
    std::string text =
        fmt::format("kernel {}\n{:<16} {:<8} {:<8} {:>9} {:>7} {:>14} {:>14} {:>10} {:>10} {:>11}\n",
                    engine::select_kernel().name, "law", "state", "rotation", "particles", "threads",
                    "particle-steps", "contact-steps", "neighbours", "contacts", "integration");
    for (const std::uint32_t particles : {500u, 700u, 2'000u, 10'000u, 50'000u, 100'000u})
        for (const Result& result : measure_laws(particles)) {
            rows.push_back(to_json(result));
            text += line_of(result);
        }
    fmt::print("{}", settings.json ? rows.dump(1) + "\n" : text);
    return 0;
}

}  // namespace loam::experiments
