// Whether a sample is calibrated and the model follows it, and if not, the likeliest reason.
#pragma once

#include "experiments/bulk/study.hpp"

namespace loam::experiments {

/// Error (m/m) of direct runs up to which a curve counts as followed: the overall error of De Pue et al.
/// 2019.
inline constexpr double followed_error = 6.7e-3;

/// Fills in status, whether it is followed, and the reason, of a sample whose status is still open.
void judge(SampleOutcome& outcome, const ParameterSpace& space);

}  // namespace loam::experiments
