#include "surrogate/curve_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "draws.hpp"
#include "surrogate/designs.hpp"

namespace loam::surrogate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Sums of five squared normals at 200 inputs; the slope is then known to about sqrt(2 / 1000) / 0.29.
VectorXd sums_of_squares(const MatrixXd& inputs, const VectorXd& slope, std::uint64_t seed) {
    optimizers::Random random(seed);
    VectorXd squares(inputs.rows());
    for (Index i = 0; i < inputs.rows(); ++i)
        squares(i) = 3 * std::exp(slope.dot((inputs.row(i).transpose().array() - 0.5).matrix())) *
                     standard_normals(5, random).squaredNorm();
    return squares;
}

TEST(LogVarianceSlope, IsFoundWhereThereIsOneAndNotWhereThereIsNone) {
    const MatrixXd inputs = sobol_sequence(200, 2, {.seed = 1});
    const VectorXd freedom = VectorXd::Constant(200, 5), slope = (VectorXd(2) << 1.5, -0.7).finished();
    const VectorXd found = log_variance_slope(inputs, sums_of_squares(inputs, slope, 2), freedom);
    EXPECT_LT((found - slope).cwiseAbs().maxCoeff(), 0.5);
    int false_alarms = 0;
    for (std::uint64_t seed = 0; seed < 50; ++seed)
        false_alarms +=
            !log_variance_slope(inputs, sums_of_squares(inputs, VectorXd::Zero(2), seed), freedom).isZero(0);
    EXPECT_LE(false_alarms, 1);  // BIC lets one in a thousand through here
    EXPECT_TRUE(log_variance_slope(inputs, VectorXd::Zero(200), freedom).isZero(0));
}

TEST(LogVarianceSlope, IsBounded) {
    const MatrixXd inputs = VectorXd::LinSpaced(50, 0, 1);
    const VectorXd squares = (20 * inputs).array().exp();
    EXPECT_DOUBLE_EQ(log_variance_slope(inputs, squares, VectorXd::Ones(50))(0), 8);
}

TEST(Replicates, AreGatheredInTheOrderOfTheirFirstRow) {
    MatrixXd inputs(5, 2), rows(5, 1);
    inputs << 1, 2, 3, 4, 1, 2, 0, 0, 1, 2;
    rows << 1, 10, 4, 7, 4;
    const ReplicateGroups groups = find_replicates(inputs);
    EXPECT_EQ(groups.group, (std::vector<Index>{0, 1, 0, 2, 0}));
    EXPECT_EQ(groups.count, (VectorXd(3) << 3, 1, 1).finished());
    EXPECT_EQ(groups.inputs, (MatrixXd(3, 2) << 1, 2, 3, 4, 0, 0).finished());
    EXPECT_LT((groups.means(rows) - (VectorXd(3) << 3, 10, 7).finished()).norm(), 1e-15);
    EXPECT_LT((groups.deviations(rows) - (VectorXd(5) << -2, 0, 1, 0, 1).finished()).norm(), 1e-15);
}

// Noise alone, at repeated inputs: the estimate must be close to the sample covariance within the groups.
TEST(NoiseCovariance, OfReplicatesAloneIsTheirs) {
    optimizers::Random random(4);
    MatrixXd covariance(4, 4), inputs(300, 2), outputs(300, 4);
    covariance << 4, 1.8, 0, 0, 1.8, 1, 0.3, 0, 0, 0.3, 1, -0.4, 0, 0, -0.4, 0.5;
    const MatrixXd places = sobol_sequence(30, 2, {.seed = 3});
    for (Index i = 0; i < 300; ++i) {
        inputs.row(i) = places.row(i % 30);
        outputs.row(i) = draw(covariance, random);
    }
    const ReplicateGroups groups = find_replicates(inputs);
    const CurveBasis basis = standardised_basis(outputs);
    const MatrixXd scores = basis.scores(outputs);
    const std::vector<GaussianProcess> processes{GaussianProcess::fit(inputs, scores.col(0), {.starts = 1})};
    const MatrixXd found =
        estimate_noise_covariance({groups, scores, processes}, VectorXd::Zero(2), basis.from_scores);
    for (Index i = 0; i < 4; ++i)
        for (Index j = 0; j < 4; ++j)
            EXPECT_NEAR(found(i, j), covariance(i, j), 0.25 * std::sqrt(covariance(i, i) * covariance(j, j)));
    EXPECT_TRUE(estimate_noise_slope({groups, scores, processes}).isZero(0));
}

TEST(CurveBasis, IsUndoneAndWhitensTheNoise) {
    const MatrixXd curves = sobol_sequence(40, 5, {.seed = 2});
    const MatrixXd a = sobol_sequence(5, 5, {.seed = 3}).array() - 0.3;
    const MatrixXd noise = a * a.transpose() + 0.1 * MatrixXd::Identity(5, 5);
    for (const CurveBasis& basis : {standardised_basis(curves), whitened_basis(curves, noise)}) {
        const MatrixXd back =
            (basis.scores(curves) * basis.from_scores.transpose()).rowwise() + basis.offset.transpose();
        EXPECT_LT((back - curves).norm(), 1e-12);
        EXPECT_LT((basis.to_scores * basis.from_scores - MatrixXd::Identity(5, 5)).norm(), 1e-12);
        const MatrixXd scores = basis.scores(curves);
        EXPECT_LT((scores.transpose() * scores / 39 - MatrixXd(basis.score_variance.asDiagonal())).norm(),
                  1e-10);
        for (Index j = 1; j < 5; ++j) EXPECT_GE(basis.score_variance(j - 1), basis.score_variance(j));
    }
    const CurveBasis basis = whitened_basis(curves, noise);
    EXPECT_LT((basis.to_scores * noise * basis.to_scores.transpose() - MatrixXd::Identity(5, 5)).norm(),
              1e-12);
}

}  // namespace
}  // namespace loam::surrogate
