// Who is at fault where direct runs do not follow a sample's curve.
#include <gtest/gtest.h>

#include "experiments/bulk/verdict.hpp"

namespace loam::experiments {
namespace {

using Eigen::VectorXd;

/// A sample of four readings whose direct runs are off by `error` from the measurement, and whose emulator
/// had promised `promised` off.
SampleOutcome outcome(double error, double promised, double scatter = 1e-4) {
    SampleOutcome out;
    out.sample.emplace();
    out.sample->curve.strain = VectorXd{{0.01, 0.02, 0.03, 0.04}};
    out.fit.emplace();
    out.fit->predicted = out.sample->curve.strain.array() + promised;
    out.direct.emplace();
    out.direct->mean = out.sample->curve.strain.array() + error;
    out.direct->curves.assign(4, out.direct->mean);
    out.direct->sd = VectorXd::Constant(4, scatter);
    out.rmse = std::abs(error);
    return out;
}

TEST(BulkVerdict, TheEmulatorMisledWhereItPromisedWhatDirectRunsDoNotShow) {
    EXPECT_TRUE(was_misled(outcome(0.02, 0.001)));
    EXPECT_FALSE(was_misled(outcome(0.02, 0.018))) << "the emulator was right: the model cannot follow";
    EXPECT_FALSE(was_misled(outcome(0.006, 0))) << "direct runs follow to 6.7e-3";
    EXPECT_FALSE(was_misled(outcome(0.01, 0, 0.03)))
        << "four packings that scatter so much may be that far off";
}

TEST(BulkVerdict, TheEmulatorMisledWhereNoDirectRunEnds) {
    SampleOutcome none = outcome(0.02, 0);
    none.direct->curves.clear();
    EXPECT_TRUE(was_misled(none));
    none.direct.reset();
    EXPECT_FALSE(was_misled(none)) << "nothing is known without direct runs";
}

}  // namespace
}  // namespace loam::experiments
