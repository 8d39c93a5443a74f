#include "surrogate/curve_emulator.hpp"

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

// A smooth map from three inputs to curves of m points that has three components, and noise correlated along
// the curve.
struct Truth {
    Index m = 10;
    VectorXd slope = VectorXd::Zero(3);

    VectorXd curve(const VectorXd& x) const {
        const Eigen::ArrayXd s = Eigen::ArrayXd::LinSpaced(m, 0.1, 1);
        return 5 + std::sin(3 * x(0)) * s + 0.3 * std::exp(x(1)) * (6 * s).sin() +
               0.4 * (x(2) + x(0) * x(1)) * (9 * s).cos();
    }
    MatrixXd noise(const VectorXd& x) const {
        MatrixXd covariance(m, m);
        for (Index i = 0; i < m; ++i)
            for (Index j = 0; j < m; ++j)
                covariance(i, j) =
                    4e-4 * (std::exp(-0.3 * std::abs(static_cast<double>(i - j))) + (i == j ? 0.1 : 0));
        return covariance * std::exp(slope.dot((x.array() - 0.5).matrix()));
    }
    MatrixXd runs(const MatrixXd& inputs, std::uint64_t seed) const {
        optimizers::Random random(seed);
        MatrixXd outputs(inputs.rows(), m);
        for (Index i = 0; i < inputs.rows(); ++i) {
            const VectorXd x = inputs.row(i);
            outputs.row(i) = curve(x) + draw(noise(x), random);
        }
        return outputs;
    }
};

// n inputs, of which the first `repeated` are run four times.
MatrixXd design(Index n, Index repeated, std::uint64_t seed) {
    MatrixXd inputs(n + 3 * repeated, 3);
    inputs.topRows(n) = maximin_latin_hypercube(n, 3, seed);
    for (Index i = 0; i < 3 * repeated; ++i) inputs.row(n + i) = inputs.row(i % repeated);
    return inputs;
}

void expect_positive_definite(const MatrixXd& covariance) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(covariance);
    EXPECT_GT(eigen.eigenvalues()(0), 0);
    EXPECT_TRUE(covariance.allFinite());
}

TEST(CurveEmulator, RecoversCurvesNoiseAndCoverage) {
    const Truth truth;
    const MatrixXd inputs = design(120, 12, 1);
    const auto emulator = CurveEmulator::fit(inputs, truth.runs(inputs, 2));
    EXPECT_EQ(emulator.summary().inputs, 120);
    EXPECT_EQ(emulator.summary().runs, 156);
    EXPECT_EQ(emulator.components(), 3);
    EXPECT_EQ(emulator.summary().stopped_by, "the rest is noise");
    EXPECT_TRUE(emulator.noise().slope.isZero(0));

    // A sample covariance from 150 runs is known to about sqrt(m / 150) of its norm.
    const MatrixXd noise = truth.noise(VectorXd::Constant(3, 0.5));
    EXPECT_LT((emulator.noise().centre - noise).norm(), 0.3 * noise.norm());
    const VectorXd ratio = emulator.noise().centre.diagonal().cwiseQuotient(noise.diagonal());
    EXPECT_GT(ratio.minCoeff(), 0.55);
    EXPECT_LT(ratio.maxCoeff(), 1.55);
    expect_positive_definite(emulator.noise().centre);

    const MatrixXd fresh = sobol_sequence(200, 3, {.seed = 5}), outputs = truth.runs(fresh, 6);
    double covered = 0, mean_covered = 0, joint = 0;
    for (Index i = 0; i < fresh.rows(); ++i) {
        const VectorXd x = fresh.row(i);
        const CurvePrediction prediction = emulator.predict(x);
        const MatrixXd total = prediction.emulator_covariance + prediction.noise_covariance;
        const VectorXd error = outputs.row(i).transpose() - prediction.mean;
        const VectorXd of_mean = truth.curve(x) - prediction.mean;
        for (Index j = 0; j < truth.m; ++j) {
            covered += std::abs(error(j)) < central_90 * std::sqrt(total(j, j));
            mean_covered +=
                std::abs(of_mean(j)) < central_90 * std::sqrt(prediction.emulator_covariance(j, j));
            EXPECT_LT(std::abs(of_mean(j)), 0.08);
        }
        joint += error.dot(total.llt().solve(error)) / static_cast<double>(truth.m);
    }
    const double points = static_cast<double>(fresh.rows() * truth.m);
    EXPECT_NEAR(covered / points, 0.9, 0.035);
    EXPECT_NEAR(mean_covered / points, 0.9, 0.1);
    // Squared Mahalanobis distance over m: one, and about m / 150 more for the inverse of an estimate.
    EXPECT_NEAR(joint / static_cast<double>(fresh.rows()), 1.07, 0.17);
}

TEST(CurveEmulator, FindsNoiseThatChangesOverTheInputs) {
    Truth truth;
    truth.slope << 2.5, 0, -1;
    const MatrixXd inputs = design(120, 10, 3);
    const MatrixXd outputs = truth.runs(inputs, 4);
    const auto emulator = CurveEmulator::fit(inputs, outputs);
    EXPECT_LT((emulator.noise().slope - truth.slope).cwiseAbs().maxCoeff(), 0.6);
    const VectorXd corner = (VectorXd(3) << 0.9, 0.5, 0.1).finished();
    const double expected = truth.noise(corner).trace();
    EXPECT_NEAR(emulator.predict(corner).noise_covariance.trace() / expected, 1, 0.45);
    EXPECT_TRUE(CurveEmulator::fit(inputs, outputs, {.noise_slope = false}).noise().slope.isZero(0));
}

TEST(CurveEmulator, LeavesEachInputOutWithTheRightSpread) {
    const Truth truth;
    const MatrixXd inputs = design(80, 8, 5), outputs = truth.runs(inputs, 6);
    const auto emulator = CurveEmulator::fit(inputs, outputs);
    const CurveLeaveOneOut left_out = emulator.leave_one_out();
    ASSERT_EQ(left_out.z.rows(), 80);
    ASSERT_EQ(left_out.z.cols(), truth.m);
    // Replicates are compared by their mean.
    EXPECT_LT(
        (left_out.actual.row(0) - (outputs.row(0) + outputs.row(80) + outputs.row(88) + outputs.row(96)) / 4)
            .norm(),
        1e-12);
    EXPECT_NEAR(left_out.z.squaredNorm() / static_cast<double>(left_out.z.size()), 1, 0.35);
    EXPECT_NEAR(left_out.coverage.mean(), 0.9, 0.06);
    double inside = 0, squares = 0, fitted = 0;
    for (Index i = 0; i < 80; ++i) {
        inside += std::abs(left_out.z(i, 4)) < central_90;
        squares += std::pow(left_out.actual(i, 4) - left_out.predicted(i, 4), 2);
        fitted += std::pow(left_out.actual(i, 4) - emulator.predict_mean(inputs.row(i).transpose())(4), 2);
    }
    EXPECT_NEAR(left_out.coverage(4), inside / 80, 1e-12);
    EXPECT_NEAR(left_out.rmse(4), std::sqrt(squares / 80), 1e-12);
    EXPECT_GT(squares, 1.05 * fitted);  // a point does not help to predict itself
}

TEST(CurveEmulator, DerivativesMatchDifferences) {
    const Truth truth;
    const MatrixXd inputs = design(60, 4, 7);
    const auto emulator = CurveEmulator::fit(inputs, truth.runs(inputs, 8), {.starts = 1});
    const VectorXd x = (VectorXd(3) << 0.3, 0.62, 0.48).finished();
    MatrixXd jacobian;
    const VectorXd mean = emulator.predict_mean(x, &jacobian);
    const ComponentPrediction scores = emulator.predict_components(x, true);
    const CurvePrediction whole = emulator.predict(x);
    EXPECT_LT((whole.mean - mean).norm(), 1e-12);
    EXPECT_LT((emulator.offset() + emulator.loadings() * scores.mean - mean).norm(), 1e-12);
    EXPECT_LT((emulator.loadings() * scores.variance.asDiagonal() * emulator.loadings().transpose() -
               whole.emulator_covariance)
                  .norm(),
              1e-15);
    EXPECT_LT((emulator.loadings() * scores.mean_jacobian - jacobian).norm(), 1e-10);
    ASSERT_EQ(jacobian.rows(), truth.m);
    for (Index k = 0; k < 3; ++k) {
        VectorXd step = VectorXd::Zero(3);
        step(k) = 1e-5;
        const VectorXd slope = (emulator.predict_mean(x + step) - emulator.predict_mean(x - step)) / 2e-5;
        EXPECT_LT((jacobian.col(k) - slope).cwiseAbs().maxCoeff(), 1e-5) << "input " << k;
        step(k) = 1e-4;
        const VectorXd variance = (emulator.predict_components(x + step).variance -
                                   emulator.predict_components(x - step).variance) /
                                  2e-4;
        EXPECT_LT((scores.variance_jacobian.col(k) - variance).cwiseAbs().maxCoeff(),
                  1e-3 * (1 + variance.cwiseAbs().maxCoeff()))
            << "input " << k;
    }
}

TEST(CurveEmulator, DoesNotDependOnTheNumberOfThreads) {
    const Truth truth;
    const MatrixXd inputs = design(40, 3, 9), outputs = truth.runs(inputs, 10);
    const VectorXd x = VectorXd::Constant(3, 0.4);
    const auto one = CurveEmulator::fit(inputs, outputs, {.seed = 3, .threads = 1}).predict(x);
    for (const int threads : {2, 3}) {
        const auto many = CurveEmulator::fit(inputs, outputs, {.seed = 3, .threads = threads}).predict(x);
        EXPECT_EQ(one.mean, many.mean);
        EXPECT_EQ(one.emulator_covariance, many.emulator_covariance);
        EXPECT_EQ(one.noise_covariance, many.noise_covariance);
    }
}

TEST(CurveEmulator, CopesWithFewRunsManyOutputsAndStillOnes) {
    Truth truth;
    truth.m = 30;
    const MatrixXd inputs = design(15, 0, 11);
    MatrixXd outputs = truth.runs(inputs, 12);
    outputs.col(7).setConstant(2.5);  // as a curve's origin
    const auto emulator = CurveEmulator::fit(inputs, outputs);
    const CurvePrediction prediction = emulator.predict(VectorXd::Constant(3, 0.5));
    EXPECT_NEAR(prediction.mean(7), 2.5, 1e-3);
    expect_positive_definite(prediction.noise_covariance);
    EXPECT_TRUE(prediction.emulator_covariance.allFinite());
    EXPECT_LT(
        (prediction.mean - truth.curve(VectorXd::Constant(3, 0.5))).segment(10, 20).cwiseAbs().maxCoeff(),
        0.2);

    const auto single = CurveEmulator::fit(inputs, outputs.col(29));
    EXPECT_EQ(single.components(), 1);
    EXPECT_GT(single.predict(VectorXd::Constant(3, 0.5)).noise_covariance(0, 0), 0);
}

// Two inputs whose curves are nearly of one shape, and few, noisy runs: the difference of the shapes is
// hardly more than noise is between so many outputs, but without it the inputs cannot be told apart.
TEST(CurveEmulator, TellsInputsApartWhoseCurvesAreAlike) {
    constexpr Index n = 45, m = 24;
    const MatrixXd inputs = maximin_latin_hypercube(n, 2, 21);
    const Eigen::ArrayXd s = Eigen::ArrayXd::LinSpaced(m, 0.05, 1);
    const VectorXd first = 3 * s, second = 2 * s + 0.4 * (6 * s).cos();
    const double truth = first.dot(second) / first.norm() / second.norm();
    int told_apart = 0;
    for (const std::uint64_t seed : {22, 23, 24, 25, 26}) {
        optimizers::Random random(seed);
        MatrixXd outputs(n, m);
        for (Index i = 0; i < n; ++i) {
            outputs.row(i) = (inputs(i, 0) - 0.5) * first + (inputs(i, 1) - 0.5) * second;
            for (Index k = 0; k < m; ++k) outputs(i, k) += 0.2 * random.normal();
        }
        const auto emulator = CurveEmulator::fit(inputs, outputs);
        ASSERT_GE(emulator.components(), 2);
        MatrixXd slope;
        emulator.predict_mean(VectorXd::Constant(2, 0.5), &slope);
        const double cosine = slope.col(0).dot(slope.col(1)) / slope.col(0).norm() / slope.col(1).norm();
        told_apart += std::abs(cosine - truth) < 0.02 ? 1 : 0;
    }
    EXPECT_GE(told_apart, 4);
}

// More outputs than inputs and smooth noise. Of the correlations between scores each is too small to be
// believed, but together they make nearly half of the outputs' variance.
TEST(CurveEmulator, KnowsTheSizeOfSmoothNoiseOnManyOutputs) {
    constexpr Index n = 57, m = 96;
    const Eigen::ArrayXd s = Eigen::ArrayXd::LinSpaced(m, 0.05, 1);
    MatrixXd covariance(m, m);
    for (Index i = 0; i < m; ++i)
        for (Index j = 0; j < m; ++j) {
            const double distance = static_cast<double>(i - j) / 6;
            covariance(i, j) = 0.01 * (std::exp(-distance * distance) + (i == j ? 0.01 : 0));
        }
    for (const std::uint64_t seed : {1, 2, 3}) {
        optimizers::Random random(seed);
        MatrixXd inputs(n + 24, 2), outputs(n + 24, m);
        inputs.topRows(n) = maximin_latin_hypercube(n, 2, seed);
        for (Index i = 0; i < 24; ++i) inputs.row(n + i) = inputs.row(i / 4);
        for (Index i = 0; i < inputs.rows(); ++i) {
            const double a = inputs(i, 0), b = inputs(i, 1);
            outputs.row(i) = (a * 3 * s + (0.3 + b) * (6 * s).cos() + a * b * (4 * s).sin()).matrix() +
                             draw(covariance, random);
        }
        const auto emulator = CurveEmulator::fit(inputs, outputs);
        // 81 runs and some sixteen directions: chance moves the mean variance by 4 %; fitting takes up some
        // more.
        EXPECT_NEAR(emulator.noise().centre.trace() / covariance.trace(), 1, 0.17);
        EXPECT_NEAR(emulator.leave_one_out().coverage.mean(), 0.9, 0.03);
    }
}

// A third shape that only inputs of x0 > 0.8 show, at a few times the noise, and a crowd of runs elsewhere,
// as rounds about an estimate add: in the variance over all inputs it drowns, and places that show it would
// be taken for places that do not.
TEST(CurveEmulator, KeepsWhatShowsAtTheFewInputsOfAnEdge) {
    constexpr Index spread = 60, crowd = 60, m = 24;
    const Eigen::ArrayXd s = Eigen::ArrayXd::LinSpaced(m, 0.05, 1);
    const VectorXd third = 0.7 * (20 * s).sin();
    const auto curve = [&](double x0, double x1) -> VectorXd {
        const double edge = std::max(0.0, x0 - 0.8) / 0.2;
        return ((x0 - 0.5) * 3 * s + (x1 - 0.5) * (6 * s).cos()).matrix() + edge * edge * third;
    };
    for (const std::uint64_t seed : {31, 32, 33}) {
        optimizers::Random random(seed);
        MatrixXd inputs(spread + crowd, 2), outputs(spread + crowd, m);
        inputs.topRows(spread) = maximin_latin_hypercube(spread, 2, seed);
        for (Index i = spread; i < inputs.rows(); ++i)
            inputs.row(i) << 0.3 + 0.05 * random.normal(), 0.5 + 0.05 * random.normal();
        for (Index i = 0; i < inputs.rows(); ++i) {
            outputs.row(i) = curve(inputs(i, 0), inputs(i, 1));
            for (Index k = 0; k < m; ++k) outputs(i, k) += 0.2 * random.normal();
        }
        const auto emulator = CurveEmulator::fit(inputs, outputs);
        const VectorXd mean = emulator.predict_mean((VectorXd(2) << 0.97, 0.5).finished());
        EXPECT_LT((mean - curve(0.97, 0.5)).norm(), 0.5 * (0.85 * 0.85 * third).norm());
        EXPECT_EQ(emulator.components(), 3);
    }
}

TEST(CurveEmulator, ReproducesCurvesWithoutNoise) {
    const Truth truth;
    const MatrixXd inputs = design(80, 0, 13);
    MatrixXd outputs(80, truth.m);
    for (Index i = 0; i < 80; ++i) outputs.row(i) = truth.curve(inputs.row(i).transpose());
    const auto emulator = CurveEmulator::fit(inputs, outputs);
    const MatrixXd fresh = sobol_sequence(50, 3, {.seed = 1});
    for (Index i = 0; i < 50; ++i) {
        const VectorXd x = fresh.row(i);
        EXPECT_LT((emulator.predict_mean(x) - truth.curve(x)).cwiseAbs().maxCoeff(), 0.03);
    }
}

TEST(CurveEmulator, NamesWhatIsWrongWithItsInput) {
    const Truth truth;
    const MatrixXd inputs = design(12, 0, 1);
    const MatrixXd outputs = truth.runs(inputs, 1);
    const auto message = [](const MatrixXd& x, const MatrixXd& y, const CurveEmulatorOptions& options = {}) {
        try {
            CurveEmulator::fit(x, y, options);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    MatrixXd broken = outputs;
    broken(5, 3) = std::nan("");
    EXPECT_NE(message(inputs, broken).find("outputs: row 5, column 3"), std::string::npos);
    EXPECT_NE(message(inputs.topRows(11), outputs).find("11 rows of inputs, but 12"), std::string::npos);
    EXPECT_NE(message(inputs.topRows(4), outputs.topRows(4)).find("4 distinct inputs"), std::string::npos);
    EXPECT_NE(message(inputs, outputs, {.max_components = 0}).find("max_components = 0"), std::string::npos);
    EXPECT_NE(message(inputs, outputs, {.starts = 0}).find("starts = 0"), std::string::npos);
    EXPECT_NE(message(inputs, outputs, {.threads = -1}).find("threads = -1"), std::string::npos);
    EXPECT_NE(message(inputs, outputs, {.kernel = "x"}).find("'x'"), std::string::npos);
}

}  // namespace
}  // namespace loam::surrogate
