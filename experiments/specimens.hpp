// Specimens: packings made once for each porosity, size and seed, however many campaigns, runs and threads
// ask for them.
#pragma once

#include <array>
#include <deque>
#include <future>
#include <map>
#include <memory>
#include <mutex>

#include "experiments/ensemble/stop_token.hpp"
#include "experiments/lab_tests/registry.hpp"
#include "experiments/settings/settings.hpp"
#include "lab_data/sample.hpp"

namespace loam::experiments {

class SpecimenPool {
  public:
    /// The specimen of that porosity, shape and seed, otherwise as the settings say; made by the first thread
    /// that asks, awaited by the others. Throws Interrupted, and what make_packing and make_boxed_packing
    /// throw.
    std::shared_ptr<const Specimen> get(const SpecimenSettings& settings, double porosity,
                                        const SpecimenShape& shape, std::uint64_t seed,
                                        const StopToken& stop);

  private:
    struct Key {
        double porosity, size_spread, preparation_stress_kPa;
        std::uint32_t particles;
        std::array<double, 3> proportions;  // 0: periodic
        std::uint64_t seed;
        auto operator<=>(const Key&) const = default;
    };
    using Made = std::shared_ptr<const Specimen>;

    // Of all specimens together, beyond which the oldest are forgotten: some 300 MB. A diagnosis of seven
    // tests comes back to its 900 training specimens after making 500 others.
    static constexpr std::size_t most_particles = 8'000'000;

    std::mutex mutex_;
    std::map<Key, std::shared_future<Made>> made_;
    std::deque<Key> order_;  // of being made
    std::size_t particles_ = 0;
};

/// The program's.
SpecimenPool& specimen_pool();

/// The packing of a file (lab_data/packing_file.hpp), for the engine. Throws UserError.
engine::Packing load_packing(const std::filesystem::path& file);

}  // namespace loam::experiments
