// This engine beside other codes on the same packings, laws and loading: one core each, in turn.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/workflows/benchmarks/other_codes.hpp"

namespace loam::experiments {

/// A line of the benchmark's result.
struct SpeedRow {
    std::string_view code, law;  // "loam" or another code; a law of this engine
    std::string_view rotation;   // free | blocked
    std::uint32_t particles = 0;
    int threads = 1;
    double particle_steps_per_s = 0, contact_steps_per_s = 0;
    double ratio = 1;          // this engine's speed over the code's on the same work
    std::string_view its_law;  // what the code calls the law
};

nlohmann::json to_json(const SpeedRow& row);

/// A law of this engine with the law that the other codes are asked for. Without `cohesion` in the shared law
/// this engine has none either.
struct Comparison {
    std::string_view law;
    SharedLaw shared;
    bool free_rotation;
};

/// All of them. A law that this engine has not yet is passed over.
std::span<const Comparison> comparisons();

struct InstalledCode {
    const OtherCode* code;
    std::filesystem::path program;
};

struct AgainstOptions {
    std::vector<std::uint32_t> particles = {700, 2000, 10000};
    int repeats = 5;
    int warm_up = 1000;       // steps
    double work = 5e6;        // particle-steps that are timed, ...
    int fewest_steps = 1000;  // ... but at least these
};

/// How many runs of other codes that makes.
std::size_t other_runs(const std::vector<InstalledCode>& codes, const AgainstOptions& options);

struct AgainstResult {
    std::vector<SpeedRow> rows;         // medians; this engine's before those of the codes on the same work
    std::vector<std::string> failures;  // of codes, each left out from then on
};

/// `each` is called before every run of another code. Throws Interrupted when asked to stop.
AgainstResult compare_codes(std::vector<InstalledCode> codes, const AgainstOptions& options,
                            const StopToken& stop, const std::function<void()>& each);

}  // namespace loam::experiments
