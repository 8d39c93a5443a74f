// loam report: writes the report of a finished run again, from what the run stored for it.
#pragma once

#include "experiments/cli/verbs.hpp"

namespace loam::experiments {

/// Reads RUN/report.json and writes RUN/report.html, whole or not at all; prints its path. Returns 0.
/// Throws UserError if the folder holds no report.json or it cannot be used.
int run_report(const PlainArguments& arguments);

}  // namespace loam::experiments
