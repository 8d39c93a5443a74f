// Specimens: packings made once for each porosity, size and seed, however many runs and threads ask for them.
#pragma once

#include <deque>
#include <future>
#include <map>
#include <memory>
#include <mutex>

#include "engine/packing.hpp"
#include "experiments/ensemble/stop_token.hpp"
#include "experiments/settings/settings.hpp"
#include "lab_data/sample.hpp"

namespace loam::experiments {

/// Porosity at which the test's specimen is made: the setting's, else from the measured initial void ratio,
/// else the 0.47 of De Pue et al. (2019).
double target_porosity(const Settings& settings, const lab_data::Test& test);

class SpecimenPool {
  public:
    explicit SpecimenPool(const Settings& settings) : settings_(settings) {}

    /// The packing of that porosity, number of particles and seed; made by the first thread that asks,
    /// awaited by the others. Throws Interrupted, and what make_packing throws.
    std::shared_ptr<const engine::PackingResult> get(double porosity, std::uint32_t particles,
                                                     std::uint64_t seed, const StopToken& stop);

  private:
    struct Key {
        double porosity;
        std::uint32_t particles;
        std::uint64_t seed;
        auto operator<=>(const Key&) const = default;
    };
    using Packing = std::shared_ptr<const engine::PackingResult>;

    static constexpr std::size_t most_kept = 1024;

    const Settings& settings_;
    std::mutex mutex_;
    std::map<Key, std::shared_future<Packing>> made_;
    std::deque<Key> order_;  // of being made: beyond most_kept the oldest is forgotten
};

/// The packing of a file (lab_data/packing_file.hpp), for the engine. Throws UserError.
engine::Packing load_packing(const std::filesystem::path& file);

}  // namespace loam::experiments
