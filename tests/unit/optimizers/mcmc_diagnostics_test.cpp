// R-hat, effective sizes and quantiles against an independent script, closed forms and made-up faults.
#include "optimizers/mcmc_diagnostics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "optimizers/random.hpp"
#include "test_functions.hpp"

namespace loam::optimizers {
namespace {

using testing::vector;

/// Chains of x(t) = rho x(t - 1) + sqrt(1 - rho^2) e(t), from their stationary distribution, a standard
/// normal.
Matrix autoregressive(double rho, Eigen::Index n, Eigen::Index chains, std::uint64_t seed) {
    Random random(seed);
    Matrix draws(n, chains);
    for (Eigen::Index j = 0; j < chains; ++j) {
        draws(0, j) = random.normal();
        for (Eigen::Index i = 1; i < n; ++i) {
            draws(i, j) = rho * draws(i - 1, j) + std::sqrt(1 - rho * rho) * random.normal();
        }
    }
    return draws;
}

/// The table of mcmc_diagnostics_reference.py.
Matrix reference_table() {
    std::uint64_t state = 12345;
    Matrix chains(60, 3);
    for (Eigen::Index j = 0; j < 3; ++j) {
        double x = 0;
        for (Eigen::Index i = 0; i < 60; ++i) {
            state = (1103515245 * state + 12345) % (1ULL << 31);
            x = 0.6 * x + static_cast<double>(state) * 0x1p-31 - 0.5;
            chains(i, j) = x + (j == 2 ? 0.2 : 0.0);
        }
    }
    return chains;
}

TEST(McmcDiagnostics, AgreeWithTheReferenceScript) {
    const Matrix chains = reference_table();
    EXPECT_NEAR(split_rhat(chains), 1.142410442646, 1e-11);
    EXPECT_NEAR(bulk_effective_size(chains), 15.7982992019, 1e-8);
    EXPECT_NEAR(tail_effective_size(chains), 76.5310233683, 1e-8);
}

TEST(McmcDiagnostics, EffectiveSizeOfAutoregressionIsTheClosedForm) {
    // The autocorrelations rho^t sum up to (1 - rho) / (1 + rho) independent draws for each draw.
    for (const double rho : {-0.4, 0.0, 0.5, 0.9}) {
        const Matrix chains = autoregressive(rho, 20000, 4, 3);
        const double expected = 80000 * (1 - rho) / (1 + rho);
        EXPECT_NEAR(bulk_effective_size(chains), expected, 0.1 * expected) << "rho = " << rho;
    }
}

TEST(McmcDiagnostics, BulkSizeAndRhatDependOnRanksAlone) {
    const Matrix chains = autoregressive(0.5, 500, 4, 4);
    const Matrix heavy = chains.array().exp().exp();
    EXPECT_DOUBLE_EQ(bulk_effective_size(heavy), bulk_effective_size(chains));
    EXPECT_DOUBLE_EQ(tail_effective_size(heavy), tail_effective_size(chains));
}

TEST(McmcDiagnostics, IndependentDrawsAreWorthTheirNumber) {
    const Matrix chains = autoregressive(0, 5000, 4, 5);
    EXPECT_LT(split_rhat(chains), 1.002);
    EXPECT_NEAR(tail_effective_size(chains), 20000, 2000);
}

TEST(McmcDiagnostics, RhatSeesAShiftedChain) {
    Matrix chains = autoregressive(0, 1000, 4, 6);
    EXPECT_LT(split_rhat(chains), 1.01);
    chains.col(2).array() += 1.0;
    // Of the eight halves two are one sd off: their means vary by 6/8 * 2/8 * 8/7, the whole by 1 in each
    // half.
    EXPECT_NEAR(split_rhat(chains), std::sqrt(1 + 3.0 / 14), 0.03);
    EXPECT_LT(bulk_effective_size(chains), 40);
}

TEST(McmcDiagnostics, RhatSeesADifferentSpread) {
    Matrix chains = autoregressive(0, 1000, 4, 7);
    chains.col(1) *= 4;
    EXPECT_GT(split_rhat(chains), 1.1);
}

TEST(McmcDiagnostics, RhatSeesADriftThatAllChainsShare) {
    Matrix chains = autoregressive(0, 1000, 4, 8);
    for (Eigen::Index i = 0; i < 1000; ++i) chains.row(i).array() += 2e-3 * static_cast<double>(i);
    EXPECT_GT(split_rhat(chains), 1.1);
}

TEST(McmcDiagnostics, RhatSeesChainsThatAreStuck) {
    Matrix chains(100, 2);
    chains << Vector::Constant(100, 1.0), Vector::Constant(100, 2.0);
    EXPECT_GT(split_rhat(chains), 1e6);
    EXPECT_LE(bulk_effective_size(chains), 10);
    chains.setConstant(3.0);
    EXPECT_TRUE(std::isnan(split_rhat(chains)));
    EXPECT_TRUE(std::isnan(bulk_effective_size(chains)));
    EXPECT_TRUE(std::isnan(tail_effective_size(chains)));
}

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
    // Type 7 on 1, 2, 4, 8: position p (n - 1), counted from the first.
    const Vector sample = vector({8, 1, 4, 2});
    EXPECT_DOUBLE_EQ(quantile(sample, 0), 1);
    EXPECT_DOUBLE_EQ(quantile(sample, 0.25), 1.75);
    EXPECT_DOUBLE_EQ(quantile(sample, 0.5), 3);
    EXPECT_DOUBLE_EQ(quantile(sample, 0.9), 4 + 0.7 * 4);
    EXPECT_DOUBLE_EQ(quantile(sample, 1), 8);
    EXPECT_DOUBLE_EQ(quantile(vector({5}), 0.3), 5);
    Matrix draws(3, 2);
    draws << 1, 30, 3, 10, 2, 20;
    EXPECT_EQ(quantiles(draws, 0.5), vector({2, 20}));
}

TEST(Random, HasTheMomentsItShould) {
    Random random(1);
    const int n = 200000;
    double uniform = 0, normal = 0, square = 0, fourth = 0;
    std::array<int, 3> counts{};
    for (int i = 0; i < n; ++i) {
        const double u = random.uniform(), z = random.normal();
        ASSERT_TRUE(u > 0 && u < 1);
        uniform += u;
        normal += z;
        square += z * z;
        fourth += z * z * z * z;
        counts[static_cast<std::size_t>(random.index(3))] += 1;
    }
    // Four standard errors each.
    const double root = std::sqrt(n);
    EXPECT_NEAR(uniform / n, 0.5, 4 * std::sqrt(1.0 / 12) / root);
    EXPECT_NEAR(normal / n, 0, 4 / root);
    EXPECT_NEAR(square / n, 1, 4 * std::sqrt(2.0) / root);
    EXPECT_NEAR(fourth / n, 3, 4 * std::sqrt(96.0) / root);
    for (const int count : counts) EXPECT_NEAR(count, n / 3.0, 4 * std::sqrt(n * 2 / 9.0));
}

TEST(Random, StreamsOfASeedDiffer) {
    Random first(1, 0), second(1, 1), again(1, 0);
    const double a = first.uniform();
    EXPECT_EQ(a, again.uniform());
    EXPECT_NE(a, second.uniform());
}

}  // namespace
}  // namespace loam::optimizers
