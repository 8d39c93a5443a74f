#include "surrogate/designs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "optimizers/random.hpp"

namespace loam::surrogate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

double least_distance(const MatrixXd& points) {
    double least = 1e300;
    for (Index i = 0; i < points.rows(); ++i)
        for (Index j = 0; j < i; ++j) least = std::min(least, (points.row(i) - points.row(j)).norm());
    return least;
}

// Each column holds (i + 1/2) / n once.
void expect_latin(const MatrixXd& points) {
    for (Index c = 0; c < points.cols(); ++c) {
        Eigen::VectorXd column = points.col(c);
        std::sort(column.begin(), column.end());
        for (Index i = 0; i < points.rows(); ++i)
            ASSERT_NEAR(column(i), (static_cast<double>(i) + 0.5) / static_cast<double>(points.rows()),
                        1e-12);
    }
}

MatrixXd random_latin(Index n, Index d, std::uint64_t seed) {
    optimizers::Random random(seed);
    MatrixXd points(n, d);
    for (Index c = 0; c < d; ++c) {
        for (Index i = 0; i < n; ++i) points(i, c) = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
        for (Index i = n - 1; i > 0; --i) std::swap(points(i, c), points(random.index(i + 1), c));
    }
    return points;
}

TEST(LatinHypercube, IsLatinForAnySize) {
    for (const auto& [n, d] : {std::pair{1, 3}, {2, 2}, {7, 1}, {3, 4}, {40, 5}, {101, 2}})
        expect_latin(maximin_latin_hypercube(n, d, 11));
}

TEST(LatinHypercube, SpreadsBetterThanTheBestOfManyRandomOnes) {
    for (const auto& [n, d] : {std::pair<Index, Index>{20, 2}, {50, 5}, {100, 3}}) {
        double best = 0;
        for (std::uint64_t seed = 0; seed < 50; ++seed)
            best = std::max(best, least_distance(random_latin(n, d, seed)));
        EXPECT_GT(least_distance(maximin_latin_hypercube(n, d, 1)), 1.2 * best) << n << " x " << d;
    }
}

// The best of all 8! designs of 8 points in the plane, found by trying them.
TEST(LatinHypercube, ComesNearTheTrueOptimum) {
    MatrixXd points(8, 2);
    std::vector<double> order{0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5};
    for (Index i = 0; i < 8; ++i) points(i, 0) = order[static_cast<std::size_t>(i)] / 8;
    double optimum = 0;
    do {
        for (Index i = 0; i < 8; ++i) points(i, 1) = order[static_cast<std::size_t>(i)] / 8;
        optimum = std::max(optimum, least_distance(points));
    } while (std::next_permutation(order.begin(), order.end()));
    double found = 0;
    for (std::uint64_t seed = 0; seed < 5; ++seed)
        found = std::max(found, least_distance(maximin_latin_hypercube(8, 2, seed)));
    EXPECT_LE(found, optimum + 1e-12);
    EXPECT_GE(found, 0.89 * optimum);
}

TEST(LatinHypercube, RepeatsUnderItsSeedAndDiffersUnderAnother) {
    const MatrixXd first = maximin_latin_hypercube(30, 4, 5);
    EXPECT_EQ(first, maximin_latin_hypercube(30, 4, 5));
    EXPECT_NE(first, maximin_latin_hypercube(30, 4, 6));
}

TEST(Sobol, BeginsAsPublishedWhenNotScrambled) {
    // Sobol 1967; Bratley & Fox 1988. Gray-code order, point 0 included.
    MatrixXd expected(8, 2);
    expected << 0, 0, 0.5, 0.5, 0.75, 0.25, 0.25, 0.75, 0.375, 0.375, 0.875, 0.875, 0.625, 0.125, 0.125,
        0.625;
    EXPECT_EQ(sobol_sequence(8, 2, {.scramble = false}), expected);
}

// Of 2^k points, from a multiple of 2^k on, each of 2^k equal slices of each axis holds one, and in the first
// two dimensions, which form a (0, 2)-sequence, so does each of the elementary rectangles.
TEST(Sobol, KeepsItsStrataUnderScrambling) {
    const Index n = 64;
    for (const std::uint32_t skip : {0U, 64U, 640U}) {
        const MatrixXd points = sobol_sequence(n, 6, {.seed = 42, .skip = skip});
        ASSERT_TRUE((points.array() > 0).all() && (points.array() < 1).all());
        for (Index c = 0; c < points.cols(); ++c) {
            std::vector<int> slices(static_cast<std::size_t>(n));
            for (Index i = 0; i < n; ++i) ++slices[static_cast<std::size_t>(points(i, c) * n)];
            EXPECT_EQ(*std::max_element(slices.begin(), slices.end()), 1) << "axis " << c;
        }
        for (Index wide = 1; wide <= n; wide *= 2) {
            std::vector<int> cells(static_cast<std::size_t>(n));
            for (Index i = 0; i < n; ++i)
                ++cells[static_cast<std::size_t>(points(i, 0) * static_cast<double>(wide)) *
                            static_cast<std::size_t>(n / wide) +
                        static_cast<std::size_t>(points(i, 1) * static_cast<double>(n / wide))];
            EXPECT_EQ(*std::max_element(cells.begin(), cells.end()), 1)
                << wide << " slices of the first axis";
        }
    }
}

TEST(Sobol, ScramblingMakesEachPointUniform) {
    // Mean and variance of the first point, which is the corner without it, over seeds.
    const int seeds = 4000;
    double sum = 0, squares = 0, product = 0;
    for (int s = 0; s < seeds; ++s) {
        const MatrixXd point = sobol_sequence(1, 2, {.seed = static_cast<std::uint64_t>(s)});
        sum += point(0, 0);
        squares += point(0, 0) * point(0, 0);
        product += (point(0, 0) - 0.5) * (point(0, 1) - 0.5);
    }
    EXPECT_NEAR(sum / seeds, 0.5, 4 / std::sqrt(12.0 * seeds));
    EXPECT_NEAR(squares / seeds, 1.0 / 3, 4 * std::sqrt(4.0 / 45 / seeds));
    EXPECT_NEAR(product / seeds, 0.0, 4.0 / 12 / std::sqrt(seeds));
}

TEST(Sobol, IsContinuedBySkipping) {
    const MatrixXd whole = sobol_sequence(50, 5, {.seed = 9});
    EXPECT_EQ(whole.bottomRows(31), sobol_sequence(31, 5, {.seed = 9, .skip = 19}));
    EXPECT_NE(whole, sobol_sequence(50, 5, {.seed = 10}));
}

TEST(Designs, RefuseImpossibleSizes) {
    EXPECT_THROW(maximin_latin_hypercube(0, 2, 1), std::invalid_argument);
    EXPECT_THROW(maximin_latin_hypercube(5, 0, 1), std::invalid_argument);
    EXPECT_THROW(sobol_sequence(0, 2), std::invalid_argument);
    EXPECT_THROW(sobol_sequence(1, 1001), std::invalid_argument);
    EXPECT_THROW(sobol_sequence(2, 1, {.skip = 0x7FFFFFFF}), std::invalid_argument);
}

}  // namespace
}  // namespace loam::surrogate
