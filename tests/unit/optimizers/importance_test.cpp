// Importance sampling against densities whose moments are known.
#include "optimizers/importance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "optimizers/random.hpp"

using namespace loam::optimizers;

namespace {

/// Draws of the uniform density as the first points, weighed by the density.
WeightedDraws sample(const BatchDensity& density, Eigen::Index d, std::uint64_t seed) {
    Random random(99);
    Matrix first(d, 4000);
    for (double& entry : first.reshaped()) entry = random.uniform();
    ImportanceOptions options;
    options.seed = seed;
    return sample_by_importance(density, first, density(first), options);
}

Vector mean_of(const WeightedDraws& draws) {
    return draws.draws.transpose() * draws.weight;
}

}  // namespace

TEST(Importance, NarrowCorrelatedNormal) {
    const Vector centre{{0.3, 0.6, 0.5}};
    Matrix covariance{{4e-4, 3e-4, 0}, {3e-4, 4e-4, 0}, {0, 0, 2.5e-3}};
    const Matrix precision = covariance.inverse();
    const BatchDensity density = [&](const Matrix& x) {
        const Matrix off = x.colwise() - centre;
        return Vector(-0.5 * (off.array() * (precision * off).array()).colwise().sum().transpose());
    };
    const WeightedDraws out = sample(density, 3, 1);
    EXPECT_GT(out.effective, 300);
    EXPECT_NEAR(out.weight.sum(), 1, 1e-12);
    const Vector mean = mean_of(out);
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(mean[k], centre[k], 4 * std::sqrt(covariance(k, k) / out.effective));
    const Matrix off = out.draws.rowwise() - mean.transpose();
    const Matrix found = off.transpose() * out.weight.asDiagonal() * off;
    EXPECT_NEAR(found(0, 1), covariance(0, 1), 0.15 * covariance(0, 1));
}

TEST(Importance, OpenDirectionKeepsThePriorsQuantiles) {
    // The second variable is free, the third lies against its bound.
    const BatchDensity density = [](const Matrix& x) {
        return Vector((-0.5 * ((x.row(0).array() - 0.5) / 0.05).square() - 8 * x.row(2).array()).transpose());
    };
    const WeightedDraws out = sample(density, 3, 2);
    const Matrix draws = out.resampled(4000);
    EXPECT_NEAR((draws.col(1).array() < 0.05).cast<double>().mean(), 0.05, 0.02);
    EXPECT_NEAR((draws.col(1).array() < 0.5).cast<double>().mean(), 0.5, 0.06);
    EXPECT_NEAR(mean_of(out)[2], 1.0 / 8 - std::exp(-8) / (1 - std::exp(-8)), 0.01);
}

TEST(Importance, TwoHillsKeepTheirShares) {
    const BatchDensity density = [](const Matrix& x) {
        Vector out(x.cols());
        for (Eigen::Index k = 0; k < x.cols(); ++k) {
            const auto hill = [&](double c) {
                return std::exp(-0.5 * (x.col(k).array() - c).square().sum() / 9e-4);
            };
            out[k] = std::log(0.7 * hill(0.25) + 0.3 * hill(0.75));
        }
        return out;
    };
    const WeightedDraws out = sample(density, 2, 3);
    double left = 0;
    for (Eigen::Index k = 0; k < out.draws.rows(); ++k)
        if (out.draws(k, 0) < 0.5) left += out.weight[k];
    EXPECT_NEAR(left, 0.7, 0.06);
}

TEST(Importance, SameSeedSameBits) {
    const BatchDensity density = [](const Matrix& x) {
        return Vector(-20 * x.colwise().squaredNorm().transpose());
    };
    EXPECT_EQ(sample(density, 2, 5).draws, sample(density, 2, 5).draws);
    EXPECT_NE(sample(density, 2, 5).draws, sample(density, 2, 6).draws);
}

TEST(Importance, RefusesWhatItCannotDo) {
    const BatchDensity none = [](const Matrix& x) { return Vector(Vector::Constant(x.cols(), -INFINITY)); };
    const Matrix first = Matrix::Constant(2, 3, 0.5);
    EXPECT_THROW(sample_by_importance(none, first, Vector::Zero(3)), std::runtime_error);
    EXPECT_THROW(sample_by_importance(none, first, Vector::Zero(2)), std::invalid_argument);
    EXPECT_THROW(sample_by_importance(none, first, Vector::Constant(3, NAN)), std::invalid_argument);
    ImportanceOptions options;
    options.draws = 1;
    EXPECT_THROW(sample_by_importance(none, first, Vector::Zero(3), options), std::invalid_argument);
}
