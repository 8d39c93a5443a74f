// loam check: is this sample, data set or configuration sound?
#pragma once

#include "experiments/cli/verbs.hpp"

namespace loam::experiments {

/// Prints what is there on standard output and every fault on standard error. Returns 0 if there is none,
/// else 2. Throws UserError if there is nothing at the path.
int run_check(const PlainArguments& arguments);

}  // namespace loam::experiments
