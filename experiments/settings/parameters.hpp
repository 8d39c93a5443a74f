// The parameters of the contact law and its effects among the settings: which are held fixed, and the priors
// of the others.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/effects/model_effects.hpp"
#include "experiments/settings/reading.hpp"

namespace loam::experiments {

/// "normal", "lognormal", "uniform", "loguniform".
std::string_view to_string(engine::PriorKind kind);

/// Whether mean and sd (or only the bounds) describe it.
bool has_mean(engine::PriorKind kind);

/// Whether it is the log10 of the value that is spread.
bool is_logarithmic(engine::PriorKind kind);

/// Whether the settings' verb fits parameters.
bool is_fitting(const Settings& settings);

/// Sets rotation to free where the effect of that name is among the effects.
void free_rotation_where_it_is_an_effect(Settings& settings);

/// Adds an effect to complete settings, with the default priors of its parameters, and freed rotation where
/// it needs that and the settings block it.
void add_effect(Settings& settings, const ModelEffect& effect);

/// Those of the settings' law, then of their effects in the order given. The law must exist; what is no
/// effect is left out.
std::vector<engine::ParameterInfo> model_parameters(const Settings& settings);

/// Fills settings.priors: for every parameter that is not fixed, its default with what the draft states. A
/// parameter that is held unless a prior is stated goes to settings.set. A stated prior of a parameter
/// that an option fixes is ignored. The law must exist. Throws UserError.
void complete_priors(Settings& settings, const Draft& draft);

/// Checks that the effects, which must exist, have the rotation that they need. Throws UserError.
void check_effects(const Settings& settings, const Origins& origins);

/// Checks names and values of [set] and [priors]. The law must exist. Throws UserError.
void check_parameters(const Settings& settings, const Origins& origins);

}  // namespace loam::experiments
