#include "experiments/cli/verbs.hpp"

#include <array>

#include "experiments/workflows/bench.hpp"
#include "experiments/workflows/bulk.hpp"
#include "experiments/workflows/calibrate.hpp"
#include "experiments/workflows/check.hpp"
#include "experiments/workflows/crosstest.hpp"
#include "experiments/workflows/diagnose.hpp"
#include "experiments/workflows/effects.hpp"
#include "experiments/workflows/report.hpp"
#include "experiments/workflows/simulate.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

int explain_test(const PlainArguments&) {
    throw lab_data::UserError({.column = "test",
                               .constraint = "is run by the launcher, which builds the tests first",
                               .remedy = "at the root of the source tree, run ./loam test"});
}

// clang-format off
const std::array table{
    Verb{"check", "is this sample, data set or configuration sound?", "PATH",
         "folder of a sample or a data set, or a configuration file (.toml)",
         "loam check lab_data/sets/dobrany_sand", run_check},
    Verb{"simulate", "run the virtual tests forward with given parameters", "SAMPLE", "folder of the sample",
         "loam simulate lab_data/sets/dobrany_sand --tests oedometer --set young_modulus=1e8 --set friction_angle=0.3",
         run_simulate},
    Verb{"calibrate", "fit one sample's contact parameters to its measured curves", "SAMPLE", "folder of the sample",
         "loam calibrate lab_data/sets/dobrany_sand --tests oedometer", run_calibrate},
    Verb{"bulk", "calibrate every sample of a data set from one shared ensemble", "DATASET", "folder of the data set",
         "loam bulk lab_data/sets/flanders_twin_125", run_bulk},
    Verb{"crosstest", "fit triaxial and direct shear tests apart, exchange the parameter sets, compare", "SAMPLE",
         "folder of the sample", "loam crosstest lab_data/sets/twin_coarse_sand --law linear-damped", run_crosstest},
    Verb{"diagnose", "find where the calibrated model fails, name the missing effect, add it, show the gap shrink",
         "SAMPLE", "folder of the sample",
         "loam diagnose lab_data/sets/twin_coarse_sand --law linear-damped", run_diagnose},
    Verb{"report", "write the report of a run again", "RUN", "folder of the run",
         "loam report runs/calibrate-dobrany-sand", run_report},
    Verb{"effects", "list laws and effects with parameters, units, bounds, sources", "", "",
         "loam effects", run_effects},
    Verb{"bench", "run a benchmark: twins | joint-twins | diagnose | atlas | bulk | rate | engine", "NAME", "which benchmark", "loam bench engine", run_bench},
    Verb{"test", "run the test suite (see ./loam test --help)", "", "", "loam test", explain_test},
};
// clang-format on

}  // namespace

std::span<const Verb> verbs() {
    return table;
}

}  // namespace loam::experiments
