#include "surrogate/gp_likelihood.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "draws.hpp"
#include "surrogate/designs.hpp"
#include "surrogate/gaussian_process.hpp"

namespace loam::surrogate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double relative_floor = 1e-8;

// 12 inputs of which three are repeated; two rows of one input have another known variance.
struct Replicated {
    MatrixXd inputs{18, 2};
    VectorXd outputs, known{18};
    Hyperparameters at{
        .variance = 1.7, .length_scales = (VectorXd(2) << 0.4, 0.9).finished(), .nugget = 0.08};
    GaussianProcessOptions options{.noise_slope = (VectorXd(2) << 1.2, -0.5).finished()};

    Replicated() {
        inputs.topRows(12) = sobol_sequence(12, 2, {.seed = 3});
        for (const auto& [row, of] : {std::pair{12, 0}, {13, 0}, {14, 4}, {15, 7}, {16, 7}, {17, 7}})
            inputs.row(row) = inputs.row(of);
        known.setConstant(0.02);
        known.tail(2).setConstant(0.3);
        optimizers::Random random(5);
        outputs = 3 + standard_normals(18, random).array() + 2 * inputs.col(0).array();
    }
    // Covariance of all rows, floor included, which is relative to the spread of the outputs.
    MatrixXd covariance(double floor) const {
        MatrixXd k = matern_between(inputs, inputs, at.variance, at.length_scales);
        for (Index i = 0; i < 18; ++i) {
            const double factor =
                std::exp(options.noise_slope.dot((inputs.row(i).transpose().array() - 0.5).matrix()));
            k(i, i) += floor + known(i) + at.nugget * factor;
        }
        return k;
    }
};

double floor_of(const VectorXd& outputs) {
    return relative_floor * (outputs.array() - outputs.mean()).square().mean();
}

TEST(RestrictedLikelihood, EqualsThatOfAllRowsWithReplicatesGathered) {
    const Replicated data;
    const auto process =
        GaussianProcess::condition(data.inputs, data.outputs, data.at, data.options, data.known);
    EXPECT_EQ(process.data().mean.size(), 13);  // 12 inputs, one with two known variances
    // Harville 1974: restricted likelihood of y = 1 mu + e with covariance K.
    const MatrixXd k = data.covariance(floor_of(data.outputs));
    const MatrixXd inverse = k.inverse();
    const VectorXd one = VectorXd::Ones(18);
    const double precision = one.dot(inverse * one), mean = one.dot(inverse * data.outputs) / precision;
    const VectorXd residual = data.outputs - mean * one;
    const double expected = -0.5 * (17 * std::log(2 * std::numbers::pi) + std::log(k.determinant()) +
                                    std::log(precision / 18) + residual.dot(inverse * residual));
    EXPECT_NEAR(process.summary().log_likelihood, expected, 1e-8);
}

TEST(RestrictedLikelihood, OfAConstantIsTheLimitOfAVanishingResponseAtTheBestNugget) {
    const Replicated data;
    const auto process = GaussianProcess::condition(data.inputs, data.outputs, data.at, data.options);
    const double alone = constant_log_likelihood(process.data());
    double best = -1e300, nearest = 0;
    for (double nugget = 0.2; nugget < 5; nugget *= 1.002) {
        Hyperparameters still = data.at;
        still.variance = 1e-12;
        still.nugget = nugget;
        const double value = GaussianProcess::condition(data.inputs, data.outputs, still, data.options)
                                 .summary()
                                 .log_likelihood;
        EXPECT_LE(value, alone + 1e-6);
        if (value > best) best = value, nearest = nugget;
    }
    EXPECT_NEAR(best, alone, 1e-4);
    EXPECT_GT(nearest, 0.3);
    EXPECT_LT(nearest, 4.5);
}

TEST(RestrictedLikelihood, PredictionsEqualThoseFromAllRows) {
    const Replicated data;
    const auto process =
        GaussianProcess::condition(data.inputs, data.outputs, data.at, data.options, data.known);
    const MatrixXd inverse = data.covariance(floor_of(data.outputs)).inverse();
    const VectorXd one = VectorXd::Ones(18);
    const double precision = one.dot(inverse * one), mean = one.dot(inverse * data.outputs) / precision;
    for (const VectorXd& x : {VectorXd::Constant(2, 0.3).eval(), (VectorXd(2) << 0.95, 0.1).finished()}) {
        const VectorXd cross =
            matern_between(data.inputs, x.transpose(), data.at.variance, data.at.length_scales);
        const double open = 1 - one.dot(inverse * cross);
        const auto prediction = process.predict(x);
        EXPECT_NEAR(prediction.mean, mean + cross.dot(inverse * (data.outputs - mean * one)), 1e-9);
        EXPECT_NEAR(prediction.variance,
                    data.at.variance - cross.dot(inverse * cross) + open * open / precision, 1e-9);
        EXPECT_NEAR(process.predict_mean(x), prediction.mean, 1e-12);
    }
}

TEST(RestrictedLikelihood, GradientMatchesDifferences) {
    const Replicated data;
    for (const char* kernel : {"matern52", "squared_exponential"}) {
        GaussianProcessOptions options = data.options;
        options.kernel = kernel;
        const auto process =
            GaussianProcess::condition(data.inputs, data.outputs, data.at, options, data.known);
        RestrictedLikelihood likelihood(find_kernel(kernel), process.data(), 1e-8);
        const VectorXd at = data.at.to_log();
        VectorXd gradient;
        EXPECT_EQ(likelihood.value(at, &gradient), likelihood.value(at, nullptr));
        ASSERT_EQ(gradient.size(), 4);
        for (Index k = 0; k < 4; ++k) {
            VectorXd step = VectorXd::Zero(4);
            step(k) = 1e-5;
            const double slope =
                (likelihood.value(at + step, nullptr) - likelihood.value(at - step, nullptr)) / 2e-5;
            EXPECT_NEAR(gradient(k), slope, 1e-6 * (1 + std::abs(slope))) << kernel << ", parameter " << k;
        }
    }
}

TEST(RestrictedLikelihood, IsNoNumberWhereTheCovarianceIsSingular) {
    GroupedData data{.inputs = MatrixXd::Constant(3, 1, 0.5),
                     .mean = VectorXd::LinSpaced(3, -1, 1),
                     .count = VectorXd::Ones(3),
                     .scatter = VectorXd::Zero(3),
                     .known_variance = VectorXd::Zero(3),
                     .noise_factor = VectorXd::Ones(3)};
    RestrictedLikelihood likelihood(find_kernel("matern52"), data, 0);
    EXPECT_TRUE(std::isnan(likelihood.value((VectorXd(3) << 0, 0, -1000).finished(), nullptr)));
}

TEST(Hyperparameters, LogarithmsAreUndone) {
    const Replicated data;
    const Hyperparameters back = Hyperparameters::from_log(data.at.to_log());
    EXPECT_NEAR(back.variance, 1.7, 1e-14);
    EXPECT_NEAR(back.nugget, 0.08, 1e-15);
    EXPECT_LT((back.length_scales - data.at.length_scales).norm(), 1e-14);
}

}  // namespace
}  // namespace loam::surrogate
