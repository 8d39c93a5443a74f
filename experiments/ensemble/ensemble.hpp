// Runs an ensemble: one run a core, results kept in the store as they finish, and only what is not there yet
// is run. The result does not depend on the number of workers, on the order of finishing, or on
// interruptions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "experiments/ensemble/run_record.hpp"
#include "experiments/ensemble/stop_token.hpp"
#include "experiments/store/ensemble_store.hpp"

namespace loam::experiments {

/// Makes one run. It must depend on the spec alone, use one thread, and throw Interrupted soon after the
/// token asks it to stop. `spec` of the record need not be filled. A failure is a record that is not ok and
/// has a reason, or any exception but Interrupted and std::bad_alloc.
using RunFunction = std::function<RunRecord(const RunSpec&, const StopToken&)>;

struct EnsembleProgress {
    std::size_t total = 0;
    std::size_t reused = 0;    // in the store before
    std::size_t executed = 0;  // finished and stored by this call
    std::size_t failed = 0;    // of both
    double seconds = 0;        // since the call began
};

struct EnsembleOptions {
    int jobs = 0;                           // runs at once; 0: one a core
    double seconds_between_progress = 0.2;  // > 0
    // Both are called by the thread that called run_ensemble, at any time, never at once.
    std::function<void(const EnsembleProgress&)> on_progress = {};  // at least once, at the end
    std::function<void(const RunRecord&)> on_record = {};  // a run of this call is stored: on the disk
    /// Throws std::invalid_argument.
    void validate() const;
};

struct EnsembleSummary {
    std::vector<RunRecord> records = {};  // one a spec, in the order of the specs
    std::size_t reused = 0;
    std::size_t executed = 0;
    std::size_t failed = 0;
    double seconds = 0;
};

/// Makes the runs that are not in the store and returns all that were asked for. Ends with a checkpoint of
/// the store. SIGINT and SIGTERM stop it; a caller with other steps before or after holds a SignalScope of
/// its own and asks its token between them. Throws
/// - Interrupted when asked to stop: running runs are given up, finished ones are in the store;
/// - lab_data::UserError if a spec is in the store with other parameters, seed, purpose or particles, or if
/// the
///   store cannot be written, StorageError if the disk is full;
/// - std::invalid_argument if options are not valid, two specs have the same index, or a run's result does
/// not fit
///   the store's header; std::bad_alloc.
EnsembleSummary run_ensemble(EnsembleStore& store, std::span<const RunSpec> specs, const RunFunction& run,
                             const EnsembleOptions& options = {});

}  // namespace loam::experiments
