// Where training runs are made: windows of the unit cube, and points within them by the priors' quantiles.
#include <gtest/gtest.h>

#include "experiments/settings/validation.hpp"
#include "experiments/training_design.hpp"
#include "surrogate/designs.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A normal prior of sd 0.1 about the middle of its coordinate, and a uniform one.
ParameterSpace two_priors() {
    ParameterSpace space;
    space.priors = {{surrogate::PriorKind::normal, 5, 1, 0, 10}, {surrogate::PriorKind::uniform, 0, 0, 0, 1}};
    space.fitted = {0, 1};
    return space;
}

TEST(Window, HoldsTheDrawsAndAMarginOnEitherSide) {
    MatrixXd draws(1001, 2);
    for (Index k = 0; k <= 1000; ++k) draws.row(k) << 0.4 + 0.1e-3 * k, 1e-3 * k;
    const Window window = window_about(draws);
    // 0.0001 less than the range at either end, wider by half of the rest and 0.03.
    EXPECT_NEAR(window.lower[0], 0.4001 - 0.5 * 0.0998 - 0.03, 1e-12);
    EXPECT_NEAR(window.upper[0], 0.4999 + 0.5 * 0.0998 + 0.03, 1e-12);
    EXPECT_EQ(window.lower[1], 0);
    EXPECT_EQ(window.upper[1], 1);
}

TEST(Window, OfDrawsAtABoundIsNotEmpty) {
    for (const double at : {0.0, 1.0}) {
        const Window window = window_about(MatrixXd::Constant(50, 1, at));
        EXPECT_LE(window.lower[0], at);
        EXPECT_GE(window.upper[0], at);
        EXPECT_GT(window.upper[0] - window.lower[0], 0.02);
        EXPECT_GE(window.lower[0], 0);
        EXPECT_LE(window.upper[0], 1);
    }
}

TEST(Window, HullHoldsBoth) {
    const Window a{VectorXd::Constant(1, 0.2), VectorXd::Constant(1, 0.3)},
        b{VectorXd::Constant(1, 0.25), VectorXd::Constant(1, 0.9)};
    EXPECT_EQ(hull(a, b).lower[0], 0.2);
    EXPECT_EQ(hull(a, b).upper[0], 0.9);
}

TEST(FromProbabilities, FillsTheWindowAsThePriorDoes) {
    const ParameterSpace space = two_priors();
    const MatrixXd u = surrogate::maximin_latin_hypercube(400, 2, 7);
    const Window window{(VectorXd(2) << 0.5, 0.2).finished(), (VectorXd(2) << 1.0, 0.4).finished()};
    const MatrixXd x = from_probabilities(space, window, u);
    EXPECT_GE(x.col(0).minCoeff(), 0.5);
    EXPECT_GE(x.col(1).minCoeff(), 0.2);
    EXPECT_LE(x.col(1).maxCoeff(), 0.4);
    // The upper half of a normal density: mean 0.5 + 0.1 sqrt(2/pi). A Latin hypercube has it to its strata.
    EXPECT_NEAR(x.col(0).mean(), 0.5 + 0.1 * std::sqrt(2 / M_PI), 1e-3);
    EXPECT_NEAR(x.col(1).mean(), 0.3, 1e-3);
}

TEST(FromProbabilities, InTheWholeCubeAreThePriorsQuantiles) {
    const ParameterSpace space = two_priors();
    const MatrixXd u = surrogate::maximin_latin_hypercube(40, 2, 7);
    const Window whole{VectorXd::Zero(2), VectorXd::Ones(2)};
    EXPECT_LT((from_probabilities(space, whole, u) - space.from_probabilities(u)).cwiseAbs().maxCoeff(),
              1e-9);
}

TEST(FirstWave, TrainsAnEmulatorAndLeavesEnoughForASecond) {
    for (int parameters = 1; parameters <= 12; ++parameters) {
        const int fewest = fewest_training_runs(parameters);
        for (int runs = fewest; runs < 400; ++runs) {
            const int first = first_wave(runs, parameters);
            EXPECT_GE(first, std::min(runs, fewest));
            EXPECT_LE(first, runs);
            if (first < runs) {
                EXPECT_GE(first, runs / 3);
                EXPECT_GE(runs - first, 10);
            }
        }
    }
    EXPECT_EQ(first_wave(120, 5), 40);
    EXPECT_EQ(first_wave(20, 2), 20);
}

}  // namespace
}  // namespace loam::experiments
