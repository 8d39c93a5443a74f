// Direct runs at the samples' estimates, on specimens that no emulator saw: what a calibration is judged by.
#pragma once

#include <vector>

#include "experiments/bulk/study.hpp"

namespace loam::experiments {

/// Rows to confirm, of those that were fitted: "all", "none", or a number of them spread evenly.
std::vector<std::size_t> rows_to_confirm(const BulkStudy& study, const std::string& confirm);

/// Makes the direct runs of these rows and notes what came out. `turn` tells their specimens from those of
/// earlier runs for the same samples.
void confirm_samples(SharedEnsemble& ensemble, const Settings& settings, const std::vector<std::size_t>& rows,
                     int turn, BulkStudy& study);

}  // namespace loam::experiments
