#include "surrogate/linear_algebra.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "surrogate/dense/dense.hpp"
#include "surrogate/designs.hpp"

namespace loam::surrogate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd positive_definite(Index n) {
    const MatrixXd a = sobol_sequence(n, n, {.seed = 8}).array() - 0.5;
    return a * a.transpose() / static_cast<double>(n) + 0.05 * MatrixXd::Identity(n, n);
}

MatrixXd lower_only(const MatrixXd& matrix) {
    MatrixXd lower = matrix.triangularView<Eigen::Lower>();
    lower.triangularView<Eigen::StrictlyUpper>().setConstant(std::nan(""));
    return lower;
}

struct Variant {
    const char* name;
    const DenseFunctions& functions;
};

// Those that this processor can run.
std::vector<Variant> variants() {
    std::vector<Variant> here{{"baseline", dense_baseline}};
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) here.push_back({"avx2", dense_avx2});
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl"))
        here.push_back({"avx512", dense_avx512});
    return here;
}

class Dense : public testing::TestWithParam<Variant> {};

// Around the block size of 64, where a slip at the edges would show. The upper triangle must never be read.
TEST_P(Dense, FactorsInvertsAndMultiplies) {
    const DenseFunctions& dense = GetParam().functions;
    for (const int n : {1, 2, 7, 63, 64, 65, 128, 200}) {
        const MatrixXd matrix = positive_definite(n);
        MatrixXd factor = lower_only(matrix), inverse(n, n);
        double log_determinant = 0;
        ASSERT_TRUE(dense.invert_factor(n, factor.data(), &log_determinant));
        EXPECT_TRUE(MatrixXd(factor.triangularView<Eigen::StrictlyUpper>()).isZero(0)) << n;
        EXPECT_LT((factor * matrix * factor.transpose() - MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(),
                  1e-12)
            << n;
        EXPECT_NEAR(log_determinant,
                    Eigen::SelfAdjointEigenSolver<MatrixXd>(matrix).eigenvalues().array().log().sum(),
                    1e-9 * n);
        dense.gram(n, factor.data(), inverse.data());
        const MatrixXd both = inverse.selfadjointView<Eigen::Lower>();
        EXPECT_LT((matrix * both - MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(), 1e-11) << n;
        const VectorXd vector = sobol_sequence(1, n, {.seed = 4}).transpose();
        VectorXd product(n);
        dense.multiply(n, factor.data(), false, vector.data(), product.data());
        EXPECT_LT((product - factor * vector).cwiseAbs().maxCoeff(), 1e-12) << n;
        dense.multiply(n, factor.data(), true, vector.data(), product.data());
        EXPECT_LT((product - factor.transpose() * vector).cwiseAbs().maxCoeff(), 1e-12) << n;
    }
}

TEST_P(Dense, SaysWhenAMatrixIsNotPositiveDefiniteAndLeavesIt) {
    for (const int n : {3, 100}) {
        MatrixXd matrix = positive_definite(n);
        matrix(n - 1, n - 1) = -1;
        const MatrixXd before = matrix;
        double log_determinant = 0;
        EXPECT_FALSE(GetParam().functions.invert_factor(n, matrix.data(), &log_determinant));
        EXPECT_EQ(matrix, before);
    }
}

// Vectorised sums that begin at the first aligned element would differ in their last bits.
TEST_P(Dense, GivesTheSameBitsWhereverTheNumbersLie) {
    const DenseFunctions& dense = GetParam().functions;
    for (const int n : {9, 101}) {
        const MatrixXd matrix = positive_definite(n);
        const VectorXd vector = sobol_sequence(1, n, {.seed = 4}).transpose();
        std::vector<VectorXd> first;
        for (Index offset = 0; offset < 8; ++offset) {
            VectorXd room(n * n + 8), square(n * n + 8), from(n + 8), to(n + 8), back(n + 8);
            room.segment(offset, n * n) = matrix.reshaped();
            from.segment(offset, n) = vector;
            double log_determinant = 0;
            ASSERT_TRUE(dense.invert_factor(n, room.data() + offset, &log_determinant));
            dense.gram(n, room.data() + offset, square.data() + offset);
            dense.multiply(n, room.data() + offset, false, from.data() + offset, to.data() + offset);
            dense.multiply(n, room.data() + offset, true, from.data() + offset, back.data() + offset);
            const std::vector<VectorXd> all{room.segment(offset, n * n), square.segment(offset, n * n),
                                            to.segment(offset, n), back.segment(offset, n)};
            if (offset == 0) first = all;
            for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i], first[i]) << i << " at " << offset;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, Dense, testing::ValuesIn(variants()),
                         [](const auto& entry) { return std::string(entry.param.name); });

// A library whose buffers are shared gives wrong numbers here within a few hundred calls.
TEST(LinearAlgebra, GivesTheSameBitsFromSeveralThreadsAtOnce) {
    std::vector<MatrixXd> matrices, expected;
    for (const Index n : {30, 60, 150}) {
        matrices.push_back(positive_definite(n));
        expected.push_back(matrices.back());
        double log_determinant = 0;
        ASSERT_TRUE(invert_factor(expected.back(), log_determinant));
    }
    std::vector<int> wrong(4, 0);
    std::vector<std::thread> threads;
    for (int& count : wrong) {
        threads.emplace_back([&] {
            for (int repeat = 0; repeat < 200; ++repeat) {
                for (std::size_t i = 0; i < matrices.size(); ++i) {
                    MatrixXd factor = matrices[i];
                    double log_determinant = 0;
                    count += !invert_factor(factor, log_determinant) || factor != expected[i];
                }
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

}  // namespace
}  // namespace loam::surrogate
