#include "surrogate/sensitivity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace loam::surrogate {
namespace {

using Eigen::VectorXd;
using std::numbers::pi;

// Ishigami & Homma 1990; closed form in Saltelli et al. 2008, section 4.6.
TEST(Sensitivity, FindsTheIndicesOfIshigamisFunction) {
    const double a = 7, b = 0.1;
    const std::vector<Prior> priors(3, Prior{PriorKind::uniform, 0, 0, -pi, pi});
    const auto model = [&](const VectorXd& unit) {
        const VectorXd x = 2 * pi * unit.array() - pi;
        VectorXd y(2);
        y << std::sin(x(0)) + a * std::pow(std::sin(x(1)), 2) + b * std::pow(x(2), 4) * std::sin(x(0)), 3.0;
        return y;
    };
    const Sensitivity found = sobol_indices(model, priors, {.samples = 4096, .seed = 3});
    const double variance = a * a / 8 + b * std::pow(pi, 4) / 5 + b * b * std::pow(pi, 8) / 18 + 0.5;
    const double v1 = 0.5 * std::pow(1 + b * std::pow(pi, 4) / 5, 2), v2 = a * a / 8;
    const double v13 = b * b * std::pow(pi, 8) * 8 / 225;
    EXPECT_NEAR(found.mean(0), a / 2, 0.01);
    EXPECT_NEAR(found.variance(0), variance, 0.02 * variance);
    const double first[] = {v1 / variance, v2 / variance, 0},
                 total[] = {(v1 + v13) / variance, v2 / variance, v13 / variance};
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(found.first(0, k), first[k], 0.02) << k;
        EXPECT_NEAR(found.total(0, k), total[k], 0.02) << k;
    }
    // An output that does not vary has no shares, rather than shares of nothing.
    EXPECT_EQ(found.variance(1), 0);
    EXPECT_TRUE(found.first.row(1).isZero(0) && found.total.row(1).isZero(0));
    EXPECT_EQ(found.evaluations, 4096 * 5);
}

// Additive in normal coordinates: each share is the square of coefficient times sd. Truncation at 8 sd is not
// felt.
TEST(Sensitivity, WeighsInputsByTheirPriors) {
    const std::vector<Prior> priors{{PriorKind::normal, 0, 1, -8, 8}, {PriorKind::normal, 10, 2, -6, 26}};
    const auto model = [&](const VectorXd& unit) {
        return VectorXd::Constant(1, 3 * priors[0].from_unit(unit(0)) + priors[1].from_unit(unit(1)));
    };
    const Sensitivity found = sobol_indices(model, priors);
    EXPECT_NEAR(found.mean(0), 10, 0.01);
    EXPECT_NEAR(found.variance(0), 9 + 4, 0.1);
    EXPECT_NEAR(found.first(0, 0), 9.0 / 13, 0.01);
    EXPECT_NEAR(found.first(0, 1), 4.0 / 13, 0.01);
    EXPECT_NEAR(found.total(0, 0), 9.0 / 13, 0.01);
    EXPECT_NEAR(found.total(0, 1), 4.0 / 13, 0.01);
}

TEST(Sensitivity, RefusesWhatCannotWork) {
    const auto model = [](const VectorXd& x) { return x; };
    EXPECT_THROW(sobol_indices(model, {}), std::invalid_argument);
    const std::vector<Prior> one(1), wrong{Prior{PriorKind::uniform, 0, 0, 1, 0}};
    EXPECT_THROW(sobol_indices(model, one, {.samples = 8}), std::invalid_argument);
    EXPECT_THROW(sobol_indices(model, wrong), std::invalid_argument);
}

}  // namespace
}  // namespace loam::surrogate
