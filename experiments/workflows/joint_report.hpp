// What a report says of several tests that are fitted at once: which test identifies which parameter, and
// what one kind of test must give up for another.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/calibration.hpp"

namespace loam::experiments {

/// The `identification` member: for every fitted test alone, each parameter's standard deviation over that of
/// its prior, from the emulator's slopes at the estimate (linearised; 1: the test says nothing of it).
nlohmann::json identification_document(const Campaign& campaign, const Calibration& calibration);

/// The `trade_off` member: for every pair of kinds of test, the errors of parameter sets that no other set
/// beats in both, by the emulator: rms of simulated - measured over what is tolerable. Sets are taken from
/// the posterior and from all over the prior. Empty where one kind alone is fitted.
nlohmann::json trade_off_document(const Campaign& campaign, const Calibration& calibration);

}  // namespace loam::experiments
