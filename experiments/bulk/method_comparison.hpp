// The method of the paper beside the default one, from the same runs.
#pragma once

#include "experiments/bulk/study.hpp"

namespace loam::experiments {

/// For up to 125 of the samples that were fitted and not refuted by direct runs that all failed, spread
/// evenly: the errors of the curves that the emulators give at the estimates of both methods. No direct runs
/// are made, so that an error below the emulators' own says nothing. Throws what the emulators throw; a
/// sample that kriging cannot fit is left out of both.
MethodComparison compare_methods(const SharedEnsemble& ensemble, const GroupEmulators& emulators,
                                 const std::vector<BulkSample>& samples, const Settings& settings,
                                 const BulkStudy& study);

}  // namespace loam::experiments
