// The contract of every kernel in the table, and of the covariance built on it.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "surrogate/designs.hpp"
#include "surrogate/kernels/ard_covariance.hpp"
#include "surrogate/kernels/registry.hpp"

namespace loam::surrogate {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class Kernel : public testing::TestWithParam<KernelInfo> {
  protected:
    static constexpr double variance = 2.3;
    const VectorXd lengths = (VectorXd(3) << 0.3, 1.7, 0.6).finished();

    MatrixXd full(const MatrixXd& points, double of_variance, const VectorXd& of_lengths) const {
        MatrixXd value, slope;
        ArdCovariance(GetParam(), points, of_variance, of_lengths).matrix(value, slope);
        return value.selfadjointView<Eigen::Lower>();
    }
    double between(const VectorXd& a, const VectorXd& b) const {
        return ArdCovariance(GetParam(), a.transpose(), variance, lengths).vector(b)(0);
    }
};

TEST_P(Kernel, IsSymmetricWithItsVarianceOnTheDiagonal) {
    const MatrixXd points = sobol_sequence(20, 3, {.seed = 1});
    for (Index i = 0; i < points.rows(); ++i) {
        const VectorXd a = points.row(i), b = points.row((i + 7) % points.rows());
        EXPECT_DOUBLE_EQ(between(a, a), variance);
        EXPECT_DOUBLE_EQ(between(a, b), between(b, a));
        EXPECT_LT(between(a, b), variance);
        EXPECT_GT(between(a, b), 0);
    }
}

TEST_P(Kernel, IsPositiveDefinite) {
    const MatrixXd points = sobol_sequence(60, 3, {.seed = 2});
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(full(points, variance, lengths));
    EXPECT_GT(eigen.eigenvalues()(0), -1e-12 * variance);
    EXPECT_NEAR(eigen.eigenvalues().sum(), 60 * variance, 1e-9);
}

TEST_P(Kernel, MatrixAndVectorAgree) {
    const MatrixXd points = sobol_sequence(10, 3, {.seed = 3});
    const MatrixXd matrix = full(points, variance, lengths);
    const ArdCovariance covariance(GetParam(), points, variance, lengths);
    for (Index i = 0; i < points.rows(); ++i)
        EXPECT_LT((covariance.vector(points.row(i).transpose()) - matrix.col(i)).norm(), 1e-14);
}

TEST_P(Kernel, SlopeMatchesDifferencesDownToZero) {
    const ArrayXd r2 = (ArrayXd(5) << 0.0, 1e-6, 0.04, 1.0, 9.0).finished();
    ArrayXd value(5), slope(5), ahead(5), behind(5), unused(5);
    GetParam().evaluate(r2, value, slope);
    EXPECT_DOUBLE_EQ(value(0), 1);
    const double h = 1e-7;
    GetParam().evaluate(r2 + h, ahead, unused);
    GetParam().evaluate((r2 - h).max(0), behind, unused);
    for (Index i = 0; i < 5; ++i) {
        const double step = i == 0 ? h : 2 * h;
        EXPECT_NEAR(slope(i), (ahead(i) - behind(i)) / step, i < 2 ? 2e-3 : 1e-7) << "r^2 = " << r2(i);
    }
}

TEST_P(Kernel, GradientWithRespectToThePointMatchesDifferences) {
    const MatrixXd points = sobol_sequence(12, 3, {.seed = 4});
    const ArdCovariance covariance(GetParam(), points, variance, lengths);
    const VectorXd x = (VectorXd(3) << 0.2, 0.7, 0.45).finished();
    MatrixXd jacobian;
    covariance.vector(x, &jacobian);
    for (Index k = 0; k < 3; ++k) {
        VectorXd step = VectorXd::Zero(3);
        step(k) = 1e-6;
        const VectorXd slope = (covariance.vector(x + step) - covariance.vector(x - step)) / 2e-6;
        EXPECT_LT((jacobian.col(k) - slope).cwiseAbs().maxCoeff(), 1e-8) << "input " << k;
    }
}

TEST_P(Kernel, GradientWithRespectToTheLogParametersMatchesDifferences) {
    const MatrixXd points = sobol_sequence(15, 3, {.seed = 5});
    MatrixXd weights = sobol_sequence(15, 15, {.seed = 6}).array() - 0.5;
    weights = (weights + weights.transpose()).eval();
    MatrixXd value, slope;
    const ArdCovariance covariance(GetParam(), points, variance, lengths);
    covariance.matrix(value, slope);
    const VectorXd gradient = covariance.contract(value, slope, weights);
    ASSERT_EQ(gradient.size(), 4);
    const double h = 1e-5;
    for (Index k = 0; k < 4; ++k) {
        const auto at = [&](double step) {
            VectorXd moved = lengths;
            if (k > 0) moved(k - 1) *= std::exp(step);
            return full(points, k == 0 ? variance * std::exp(step) : variance, moved)
                .cwiseProduct(weights)
                .sum();
        };
        EXPECT_NEAR(gradient(k), (at(h) - at(-h)) / (2 * h), 1e-7) << "parameter " << k;
    }
}

INSTANTIATE_TEST_SUITE_P(All, Kernel, testing::ValuesIn(kernels().begin(), kernels().end()),
                         [](const auto& entry) { return std::string(entry.param.name); });

// Rasmussen & Williams 2006, eqs 4.9 and 4.17, at r = 1 and r = 2.
TEST(Kernels, HaveThePublishedValues) {
    const ArrayXd r2 = (ArrayXd(2) << 1.0, 4.0).finished();
    ArrayXd value(2), slope(2);
    find_kernel("squared_exponential").evaluate(r2, value, slope);
    EXPECT_NEAR(value(0), 0.6065306597126334, 1e-15);
    EXPECT_NEAR(value(1), 0.1353352832366127, 1e-15);
    find_kernel("matern52").evaluate(r2, value, slope);
    EXPECT_NEAR(value(0), (1 + std::sqrt(5.0) + 5.0 / 3) * std::exp(-std::sqrt(5.0)), 1e-15);
    EXPECT_NEAR(value(1), (1 + 2 * std::sqrt(5.0) + 20.0 / 3) * std::exp(-2 * std::sqrt(5.0)), 1e-15);
}

TEST(Kernels, AnUnknownNameIsAnsweredWithTheKnownOnes) {
    try {
        find_kernel("matern53");
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("'matern53'"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("matern52, squared_exponential"), std::string::npos);
    }
}

}  // namespace
}  // namespace loam::surrogate
