// The parameters of the contact law among the settings: which are held fixed, and the priors of the others.
#pragma once

#include <string>
#include <string_view>

#include "experiments/settings/reading.hpp"

namespace loam::experiments {

/// "normal", "lognormal", "uniform", "loguniform".
std::string_view to_string(engine::PriorKind kind);

/// Whether mean and sd (or only the bounds) describe it.
bool has_mean(engine::PriorKind kind);

/// Whether it is the log10 of the value that is spread.
bool is_logarithmic(engine::PriorKind kind);

/// Fills settings.priors: for every parameter of the law that is not fixed, the law's default with what the
/// draft states. A stated prior of a fixed parameter is ignored. The law must exist. Throws UserError.
void complete_priors(Settings& settings, const Draft& draft);

/// Checks names and values of [set] and [priors]. The law must exist. Throws UserError.
void check_parameters(const Settings& settings, const Origins& origins);

}  // namespace loam::experiments
