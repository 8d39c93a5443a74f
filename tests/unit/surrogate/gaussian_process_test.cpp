#include "surrogate/gaussian_process.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "draws.hpp"
#include "surrogate/designs.hpp"

namespace loam::surrogate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double central_90 = 1.6448536269514722;

double smooth(const VectorXd& x) {
    return 100 + std::sin(5 * x(0)) + std::exp(x(1)) * x(0);
}

VectorXd values(const MatrixXd& inputs, double (*f)(const VectorXd&)) {
    VectorXd y(inputs.rows());
    for (Index i = 0; i < inputs.rows(); ++i) y(i) = f(inputs.row(i).transpose());
    return y;
}

TEST(GaussianProcess, InterpolatesWhatHasNoNoise) {
    const MatrixXd inputs = maximin_latin_hypercube(50, 2, 1), fresh = sobol_sequence(100, 2, {.seed = 2});
    const VectorXd outputs = values(inputs, smooth);
    for (const char* kernel : {"matern52", "squared_exponential"}) {
        const auto process = GaussianProcess::fit(inputs, outputs, {.kernel = kernel});
        for (Index i = 0; i < inputs.rows(); ++i) {
            const auto at = process.predict(inputs.row(i).transpose());
            EXPECT_NEAR(at.mean, outputs(i), 1e-3) << kernel;
            EXPECT_LT(at.variance, 1e-6) << kernel;
        }
        const VectorXd truth = values(fresh, smooth);
        for (Index i = 0; i < fresh.rows(); ++i)
            EXPECT_NEAR(process.predict_mean(fresh.row(i).transpose()), truth(i), 0.06) << kernel;
    }
}

TEST(GaussianProcess, RecoversTheHyperparametersOfALargeSample) {
    optimizers::Random random(7);
    const MatrixXd inputs = maximin_latin_hypercube(400, 2, 4);
    const VectorXd lengths = (VectorXd(2) << 0.25, 0.6).finished();
    MatrixXd covariance = matern_between(inputs, inputs, 2.0, lengths);
    covariance.diagonal().array() += 0.05;
    const auto process = GaussianProcess::fit(inputs, draw(covariance, random).array() + 10);
    const Hyperparameters& found = process.hyperparameters();
    // Length scales are known to some 15 %, the nugget to 1 / sqrt(200); variance and length trade off.
    EXPECT_NEAR(std::log(found.length_scales(0) / 0.25), 0, 0.35);
    EXPECT_NEAR(std::log(found.length_scales(1) / 0.6), 0, 0.35);
    EXPECT_NEAR(std::log(found.nugget / 0.05), 0, 0.3);
    EXPECT_NEAR(std::log(found.variance / 2.0), 0, 0.9);
    EXPECT_EQ(process.summary().searches, 4);  // three on a subset, one on all
}

// 400 independent draws of 20 runs and one fresh point each; binomial(400, 0.9) has standard deviation 6.
TEST(GaussianProcess, IntervalsOfTheTrueModelCoverAsTheyClaim) {
    optimizers::Random random(11);
    const Hyperparameters truth{.variance = 1.5, .length_scales = VectorXd::Constant(2, 0.4), .nugget = 0.1};
    int covered = 0;
    double squares = 0;
    for (int trial = 0; trial < 400; ++trial) {
        MatrixXd points(21, 2);
        for (double& value : points.reshaped()) value = random.uniform();
        VectorXd y = draw(matern_between(points, points, truth.variance, truth.length_scales) +
                              1e-10 * MatrixXd::Identity(21, 21),
                          random);
        y.head(20) += std::sqrt(truth.nugget) * standard_normals(20, random);
        const auto process = GaussianProcess::condition(points.topRows(20), y.head(20), truth);
        const auto prediction = process.predict(points.row(20).transpose());
        const double z = (y(20) - prediction.mean) / std::sqrt(prediction.variance);
        covered += std::abs(z) < central_90;
        squares += z * z / 400;
    }
    EXPECT_NEAR(covered, 360, 21);
    EXPECT_NEAR(squares, 1, 0.25);
}

// The same with fitted hyper-parameters, whose uncertainty is left out: a little too narrow is expected at n
// = 40.
TEST(GaussianProcess, IntervalsOfFittedModelsCoverNearlyAsTheyClaim) {
    optimizers::Random random(12);
    const VectorXd lengths = (VectorXd(2) << 0.4, 0.8).finished();
    int covered = 0;
    const int trials = 120;
    for (int trial = 0; trial < trials; ++trial) {
        MatrixXd points(41, 2);
        points.topRows(40) = maximin_latin_hypercube(40, 2, static_cast<std::uint64_t>(trial));
        points.row(40) << random.uniform(), random.uniform();
        VectorXd y =
            draw(matern_between(points, points, 1, lengths) + 1e-10 * MatrixXd::Identity(41, 41), random);
        y.head(40) += 0.2 * standard_normals(40, random);
        const auto prediction = GaussianProcess::fit(points.topRows(40), y.head(40), {.starts = 2})
                                    .predict(points.row(40).transpose());
        covered += std::abs(y(40) - prediction.mean) < central_90 * std::sqrt(prediction.variance);
    }
    EXPECT_GE(covered, 0.8 * trials);
    EXPECT_LE(covered, 0.97 * trials);
}

TEST(GaussianProcess, LeaveOneOutEqualsLeavingEachInputOut) {
    optimizers::Random random(3);
    MatrixXd inputs(24, 2);
    inputs.topRows(18) = maximin_latin_hypercube(18, 2, 6);
    inputs.bottomRows(6) << inputs.row(2), inputs.row(2), inputs.row(5), inputs.row(9), inputs.row(9),
        inputs.row(9);
    const VectorXd outputs = values(inputs, smooth) + 0.1 * standard_normals(24, random);
    const Hyperparameters at{.variance = 2, .length_scales = VectorXd::Constant(2, 0.5), .nugget = 0.01};
    const auto process = GaussianProcess::condition(inputs, outputs, at);
    const auto left_out = process.leave_one_out();
    ASSERT_EQ(left_out.mean.size(), 18);
    for (Index g = 0; g < 18; ++g) {
        std::vector<Index> others, own;
        for (Index i = 0; i < 24; ++i) (inputs.row(i) == inputs.row(g) ? own : others).push_back(i);
        const auto refit = GaussianProcess::condition(inputs(others, Eigen::all), outputs(others), at);
        const auto prediction = refit.predict(inputs.row(g).transpose());
        EXPECT_NEAR(left_out.mean(g), prediction.mean, 1e-6);
        EXPECT_NEAR(left_out.variance(g), prediction.variance, 1e-6);
        const double measured = outputs(own).mean(), noise = 0.01 / static_cast<double>(own.size());
        EXPECT_NEAR(left_out.z(g), (measured - prediction.mean) / std::sqrt(prediction.variance + noise),
                    1e-4);
    }
}

TEST(GaussianProcess, GradientsOfThePredictionMatchDifferences) {
    optimizers::Random random(9);
    const MatrixXd inputs = maximin_latin_hypercube(30, 2, 1);
    const VectorXd outputs = values(inputs, smooth) + 0.05 * standard_normals(30, random);
    for (const char* kernel : {"matern52", "squared_exponential"}) {
        const auto process = GaussianProcess::fit(inputs, outputs, {.kernel = kernel});
        const VectorXd x = (VectorXd(2) << 0.33, 0.81).finished();
        const auto at = process.predict(x, true);
        VectorXd mean_gradient;
        EXPECT_NEAR(process.predict_mean(x, &mean_gradient), at.mean, 1e-12);
        EXPECT_LT((mean_gradient - at.mean_gradient).norm(), 1e-12);
        for (Index k = 0; k < 2; ++k) {
            VectorXd step = VectorXd::Zero(2);
            step(k) = 1e-5;
            const auto ahead = process.predict(x + step), behind = process.predict(x - step);
            EXPECT_NEAR(at.mean_gradient(k), (ahead.mean - behind.mean) / 2e-5, 1e-5) << kernel;
            EXPECT_NEAR(at.variance_gradient(k), (ahead.variance - behind.variance) / 2e-5, 1e-6) << kernel;
        }
    }
}

TEST(GaussianProcess, KeepsKnownNoiseApartFromTheNugget) {
    // All noise is known: the nugget has nothing left to explain.
    optimizers::Random random(21);
    const MatrixXd inputs = maximin_latin_hypercube(150, 1, 2);
    VectorXd noise_sd(150), outputs(150);
    for (Index i = 0; i < 150; ++i) {
        noise_sd(i) = i % 2 ? 0.3 : 0.1;
        outputs(i) = std::sin(6 * inputs(i, 0)) + noise_sd(i) * random.normal();
    }
    const auto process = GaussianProcess::fit(inputs, outputs, {}, noise_sd.cwiseAbs2());
    EXPECT_LT(process.hyperparameters().nugget, 0.004);
    const auto without = GaussianProcess::fit(inputs, outputs);
    EXPECT_NEAR(without.hyperparameters().nugget, 0.05, 0.02);  // the mean of 0.01 and 0.09
    EXPECT_GT(process.summary().log_likelihood, without.summary().log_likelihood + 10);
}

TEST(GaussianProcess, AConstantOutputIsPredictedAsSuch) {
    const auto process = GaussianProcess::fit(maximin_latin_hypercube(10, 2, 1), VectorXd::Constant(10, 4.5));
    const auto prediction = process.predict(VectorXd::Constant(2, 0.4));
    EXPECT_NEAR(prediction.mean, 4.5, 1e-9);
    EXPECT_LT(prediction.variance, 1e-4);
}

TEST(GaussianProcess, RepeatsUnderItsSeed) {
    optimizers::Random random(2);
    const MatrixXd inputs = maximin_latin_hypercube(80, 3, 1);
    const VectorXd outputs = standard_normals(80, random) + inputs.col(0) * 5;
    const GaussianProcessOptions options{.starts = 4, .subset = 60, .seed = 5};
    const auto a = GaussianProcess::fit(inputs, outputs, options),
               b = GaussianProcess::fit(inputs, outputs, options);
    EXPECT_EQ(a.hyperparameters().to_log(), b.hyperparameters().to_log());
    EXPECT_EQ(a.system().alpha, b.system().alpha);
}

TEST(GaussianProcess, NamesWhatIsWrongWithItsInput) {
    const MatrixXd inputs = maximin_latin_hypercube(6, 2, 1);
    const VectorXd outputs = inputs.col(0);
    const auto message = [&](const MatrixXd& x, const VectorXd& y, const GaussianProcessOptions& options = {},
                             const VectorXd& known = {}) -> std::string {
        try {
            GaussianProcess::fit(x, y, options, known);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "";
    };
    MatrixXd broken = inputs;
    broken(3, 1) = std::nan("");
    EXPECT_NE(message(broken, outputs).find("inputs: row 3, column 1"), std::string::npos);
    EXPECT_NE(message(inputs, outputs.head(5)).find("outputs has 5 entries"), std::string::npos);
    EXPECT_NE(message(inputs.topRows(2), outputs.head(2)).find("2 distinct inputs"), std::string::npos);
    EXPECT_NE(message(inputs, outputs, {.kernel = "cubic"}).find("'cubic'"), std::string::npos);
    EXPECT_NE(message(inputs, outputs, {.starts = 0}).find("starts = 0"), std::string::npos);
    EXPECT_NE(message(inputs, outputs, {.max_evaluations = 0}).find("max_evaluations = 0"),
              std::string::npos);
    EXPECT_NE(message(inputs, outputs, {.subset = 10}).find("subset = 10"), std::string::npos);
    EXPECT_NE(message(inputs, outputs, {.relative_floor = 2}).find("relative_floor = 2"), std::string::npos);
    EXPECT_NE(message(inputs, outputs, {.noise_slope = VectorXd::Zero(3)}).find("noise_slope has 3"),
              std::string::npos);
    EXPECT_NE(message(inputs, outputs, {}, VectorXd::Constant(6, -1)).find("negative"), std::string::npos);
    EXPECT_EQ(message(inputs, outputs), "");
}

}  // namespace
}  // namespace loam::surrogate
