// Whether a sample is calibrated and the model follows it, and if not, the likeliest reason.
#pragma once

#include "experiments/bulk/study.hpp"

namespace loam::experiments {

/// Error (m/m) of direct runs up to which a curve counts as followed: the overall error of De Pue et al.
/// 2019.
inline constexpr double followed_error = 6.7e-3;

/// Whether direct runs do not follow the measured curve and the emulator, whose best curve their parameters
/// are, is at fault: they are far from what it said, by more than packings scatter, or none came to an end.
bool was_misled(const SampleOutcome& outcome);

/// Fills in status, whether it is followed, and the reason, of a sample whose status is still open.
void judge(SampleOutcome& outcome, const ParameterSpace& space);

}  // namespace loam::experiments
