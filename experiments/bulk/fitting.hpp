// Fits many samples by the method of the settings, on all cores; what is done is kept in the run folder.
#pragma once

#include <filesystem>
#include <vector>

#include "experiments/bulk/study.hpp"

namespace loam::experiments {

/// Fits those of the study's samples that the journal (a file) does not hold, by its training runs; one that
/// cannot be fitted is left with its reason. With the method "emulator" hands back the emulators. Throws
/// Interrupted, and what the emulators and the journal throw.
std::optional<GroupEmulators> fit_samples(SharedEnsemble& ensemble, const Settings& settings,
                                          const std::vector<BulkSample>& samples,
                                          const std::filesystem::path& journal, BulkStudy& study);

}  // namespace loam::experiments
