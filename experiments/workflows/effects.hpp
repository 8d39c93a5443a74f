// loam effects: the contact laws and effects with their parameters, from the tables that the engine itself
// reads.
#pragma once

#include "experiments/cli/verbs.hpp"

namespace loam::experiments {

/// Prints the tables, or with `json` an object {"laws": [...], "effects": [...]}. Returns 0.
int run_effects(const PlainArguments& arguments);

}  // namespace loam::experiments
