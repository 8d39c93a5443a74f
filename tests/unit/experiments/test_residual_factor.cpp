#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "experiments/likelihood_terms.hpp"
#include "experiments/residual_factor.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd random_matrix(Index rows, Index columns, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    MatrixXd out(rows, columns);
    for (double& value : out.reshaped()) value = normal(random);
    return out;
}

/// Three specimens of 4, 7 and 2 readings.
struct Case {
    std::vector<Stretch> stretches{{0, 4}, {4, 7}, {11, 2}};
    MatrixXd blocks = MatrixXd::Zero(13, 13);
    MatrixXd loadings = random_matrix(13, 3, 5);
    VectorXd variance{{0.5, 2.0, 0.0}};
    VectorXd residuals = random_matrix(13, 1, 6);

    Case() {
        for (const auto [first, count] : stretches) {
            const MatrixXd root = random_matrix(count, count + 2, 7 + static_cast<std::uint64_t>(first));
            blocks.block(first, first, count, count) = root * root.transpose();
        }
    }
    MatrixXd block(Stretch at) const { return blocks.block(at.first, at.first, at.count, at.count); }
};

TEST(ResidualFactor, GivesTheDensityOfTheDenseMatrix) {
    const Case given;
    ResidualFactor factor(given.loadings, given.variance, given.residuals);
    for (const Stretch& at : given.stretches) {
        MatrixXd block = given.block(at);
        ASSERT_TRUE(factor.add(at, block));
    }
    const MatrixXd dense =
        given.blocks + given.loadings * given.variance.asDiagonal() * given.loadings.transpose();
    const double expected =
        -0.5 * (std::log(dense.determinant()) + given.residuals.dot(dense.inverse() * given.residuals));
    ASSERT_TRUE(factor.log_density());
    EXPECT_NEAR(*factor.log_density(), expected, 1e-8 * std::abs(expected));
}

TEST(ResidualFactor, ExpectsTheMeanDensityOverWhatIsOpen) {
    const Case given;
    ResidualFactor factor(given.loadings, given.variance, given.residuals);
    for (const Stretch& at : given.stretches) {
        MatrixXd block = given.block(at);
        ASSERT_TRUE(factor.add(at, block));
    }
    // E[r' B^-1 r] of residuals r about the given ones, spread as the emulator leaves them.
    const MatrixXd spread = given.residuals * given.residuals.transpose() +
                            given.loadings * given.variance.asDiagonal() * given.loadings.transpose();
    const double by_hand =
        -0.5 * (std::log(given.blocks.determinant()) + (given.blocks.inverse() * spread).trace());
    EXPECT_NEAR(factor.expected_log_density(), by_hand, 1e-8 * std::abs(by_hand));
}

TEST(ResidualFactor, RefusesABlockThatIsNotPositiveDefinite) {
    const Case given;
    ResidualFactor factor(given.loadings, given.variance, given.residuals);
    MatrixXd block = given.block(given.stretches[1]);
    block(3, 3) = -1;
    EXPECT_FALSE(factor.add(given.stretches[1], block));
}

TEST(ReadingNoise, ItsBlocksAreThoseOfTheWholeMatrix) {
    Observation observation;
    observation.measured = VectorXd::LinSpaced(9, 0.001, 0.05);
    observation.misfit_priors.assign(2, strain_misfit_prior());
    const auto curve = [](Index first, Index count, int test, Index misfit, bool correlated) {
        ObservedCurve out;
        out.first = first;
        out.count = count;
        out.test = test;
        out.transform = OutputTransform{0.01, true};
        out.misfit = misfit;
        if (correlated) out.along = VectorXd::LinSpaced(count, 0.1, 1);
        return out;
    };
    observation.curves = {curve(0, 2, 3, 0, false), curve(2, 3, 5, 1, true), curve(5, 4, 5, 0, true)};
    const ReadingNoise noise(observation, transforms_of(observation));
    const VectorXd misfits{{0.003, 0.02}};
    MatrixXd whole = MatrixXd::Zero(9, 9), packing = MatrixXd::Ones(9, 9);
    noise.add(misfits, whole);
    ASSERT_EQ(noise.specimens().size(), 2u);
    double seen = 0;
    for (const auto [first, count] : noise.specimens()) {
        MatrixXd block = MatrixXd::Zero(count, count);
        noise.add(misfits, block, first);
        EXPECT_EQ(block, whole.block(first, first, count, count));
        EXPECT_EQ(noise.of_specimens(packing).block(first, first, count, count).sum(),
                  static_cast<double>(count * count));
        seen += block.cwiseAbs().sum();
    }
    EXPECT_DOUBLE_EQ(seen, whole.cwiseAbs().sum()) << "nothing lies between the blocks";
    EXPECT_EQ(noise.of_specimens(packing).sum(), 2 * 2 + 7 * 7);
}

}  // namespace
}  // namespace loam::experiments
