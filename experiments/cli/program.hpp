// The program as main() runs it: the one place where what went wrong becomes an exit status and a line on
// standard error.
#pragma once

namespace loam::experiments {

/// Exit statuses: 0 done; 1 ran but failed; 2 the user's input is at fault (UserError); 130 interrupted.
int run_program(int argc, const char* const* argv);

}  // namespace loam::experiments
