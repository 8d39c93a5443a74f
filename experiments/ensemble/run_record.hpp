// One run of an ensemble: what is asked for (RunSpec) and what came out (RunRecord).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

namespace loam::experiments {

struct RunSpec {
    std::uint64_t index = 0;     // the run's key: unique in its ensemble, and all its randomness
    std::string purpose;         // "training", "replicate", "confirmation", ...
    Eigen::VectorXd parameters;  // [d], SI, in the order of EnsembleHeader::parameters
    std::uint64_t packing_seed = 0;
    std::uint32_t particles = 0;
};

/// The same run, bit for bit.
bool same_run(const RunSpec& a, const RunSpec& b);

struct RunRecord {
    RunSpec spec;
    bool ok = false;
    std::string reason;           // why it failed; empty when ok
    Eigen::VectorXd outputs;      // [m] as EnsembleHeader::outputs; empty when failed
    Eigen::VectorXd diagnostics;  // [k] as EnsembleHeader::diagnostics; NaN: not measured
};

/// The same record, bit for bit (NaN equals the same NaN).
bool same_record(const RunRecord& a, const RunRecord& b);

}  // namespace loam::experiments
