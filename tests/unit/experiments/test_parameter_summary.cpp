// What a calibration says of a parameter: its interval, and whether the measurements identify it.
#include <gtest/gtest.h>

#include "experiments/workflows/parameter_summary.hpp"

namespace loam::experiments {
namespace {

/// Of one parameter between 0 and 1, whose prior's 90 % interval is 0.9 wide.
bool identified(double q05, double estimate, double q95) {
    ParameterSpace space;
    space.parameters.resize(1);
    space.fitted = {0};
    space.priors = {surrogate::Prior{surrogate::PriorKind::uniform, 0, 0, 0, 1}};
    space.values = Eigen::VectorXd::Constant(1, 0.5);
    const Eigen::RowVector3d quantiles(q05, (q05 + q95) / 2, q95);
    return summarise(space, Eigen::VectorXd::Constant(1, estimate), quantiles).at(0).identified;
}

TEST(ParameterSummary, AParameterIsIdentifiedWhereItsIntervalIsNarrowerThanThePriors) {
    EXPECT_TRUE(identified(0.3, 0.4, 0.5));
    EXPECT_TRUE(identified(0.1, 0.4, 0.77));
    EXPECT_FALSE(identified(0.1, 0.4, 0.78));
}

TEST(ParameterSummary, AnIntervalThatDoesNotHoldTheEstimateIdentifiesNothing) {
    EXPECT_FALSE(identified(0.3, 0.29, 0.5));
    EXPECT_FALSE(identified(0.3, 0.51, 0.5));
    // The most probable value of a parameter that is driven against its bound lies below the 5 % quantile.
    EXPECT_TRUE(identified(0.02, 0.0, 0.3));
    EXPECT_TRUE(identified(0.7, 1.0, 0.98));
}

}  // namespace
}  // namespace loam::experiments
