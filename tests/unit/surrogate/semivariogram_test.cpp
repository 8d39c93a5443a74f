// Semivariograms of numbers whose own are known.
#include "surrogate/statistics/semivariogram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

using namespace loam::surrogate;
using Eigen::VectorXd;

TEST(Semivariogram, OfAStraightLineIsHalfTheSquaredDistance) {
    const VectorXd x = VectorXd::LinSpaced(101, 0, 10);
    const auto e = experimental_semivariogram(x, 3 * x, 20);
    ASSERT_EQ(e.distance.size(), 20);
    const double within = 4.5 * 0.25 * 0.25 / 4;  // variance of the distances in a bin of width 1/4, at most
    for (Eigen::Index b = 0; b < e.distance.size(); ++b) {
        const double half_square = 4.5 * e.distance[b] * e.distance[b];
        EXPECT_GE(e.value[b], half_square - 1e-12);
        EXPECT_LE(e.value[b], half_square + within);
    }
    EXPECT_NEAR(e.pairs.sum(), 101 * 100 / 2 - 51 * 52 / 2, 52);  // those nearer than 5, or at it by rounding
}

TEST(Semivariogram, GaussianModelIsFoundAgain) {
    const GaussianSemivariogram truth{0.3, 1.7, 2.5};
    ExperimentalSemivariogram e;
    e.distance = VectorXd::LinSpaced(20, 0.2, 6);
    e.value = e.distance.unaryExpr([&](double h) { return truth.at(h); });
    e.pairs = VectorXd::LinSpaced(20, 500, 100);
    const GaussianSemivariogram found = fit_gaussian(e);
    EXPECT_NEAR(found.nugget, truth.nugget, 1e-4);
    EXPECT_NEAR(found.sill, truth.sill, 1e-4);
    EXPECT_NEAR(found.range, truth.range, 1e-3);
    EXPECT_EQ(truth.at(0), 0);
}

TEST(Semivariogram, NuggetAndSillAreNeverNegative) {
    ExperimentalSemivariogram falling;
    falling.distance = VectorXd::LinSpaced(10, 1, 10);
    falling.value = VectorXd::LinSpaced(10, 2, 1);
    falling.pairs = VectorXd::Ones(10);
    const GaussianSemivariogram flat = fit_gaussian(falling);
    EXPECT_EQ(flat.sill, 0);
    EXPECT_NEAR(flat.nugget, 1.5, 1e-12);
}

TEST(Semivariogram, RefusesWhatHasNone) {
    EXPECT_THROW(experimental_semivariogram(VectorXd::Ones(5), VectorXd::Ones(5)), std::invalid_argument);
    EXPECT_THROW(experimental_semivariogram(VectorXd::Ones(5), VectorXd::Ones(4)), std::invalid_argument);
}
