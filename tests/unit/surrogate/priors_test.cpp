#include "surrogate/priors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace loam::surrogate {
namespace {

constexpr auto normal = PriorKind::normal, lognormal = PriorKind::lognormal, uniform = PriorKind::uniform,
               loguniform = PriorKind::loguniform;

// Ordinary, narrow, one-sided and far-tail truncations.
std::vector<Prior> many_priors() {
    return {{normal, 0.4, 0.2, 0.01, 0.99},
            {lognormal, 8.5, 0.8, 1e6, 1e11},
            {uniform, 0, 0, -3, 5},
            {loguniform, 0, 0, 1e-3, 1e4},
            {normal, 0, 1, -0.01, 0.02},
            {normal, 0, 1, 5, 9},
            {normal, 0, 1, -12, -6},
            {normal, 0, 1, -30, 30},
            {lognormal, 5, 1, 1e2, 1e8},
            {normal, 3.0, 0.05, -10.0, 10.0},
            {normal, 0.314, 0.157, 0.016, 1.55}};
}

// The bounds in the coordinate that is linear in x.
bool logarithmic(const Prior& prior) {
    return prior.kind == lognormal || prior.kind == loguniform;
}
double lower(const Prior& prior) {
    return logarithmic(prior) ? std::log10(prior.lower) : prior.lower;
}
double upper(const Prior& prior) {
    return logarithmic(prior) ? std::log10(prior.upper) : prior.upper;
}

// Composite Gauss-Legendre quadrature of three points in many intervals: independent of the library under
// test.
template <class Function>
double integral(const Function& f, double a, double b, int intervals = 5000) {
    const double h = (b - a) / intervals, offset = std::sqrt(0.6) * h / 2;
    double sum = 0;
    for (int i = 0; i < intervals; ++i) {
        const double mid = a + (i + 0.5) * h;
        sum += (5 * f(mid - offset) + 8 * f(mid) + 5 * f(mid + offset)) / 18;
    }
    return sum * h;
}

TEST(Priors, DensitiesIntegrateToOneAndToTheDistribution) {
    for (const Prior& prior : many_priors()) {
        const auto density = [&](double x) { return std::exp(prior.log_density_unit(x)); };
        EXPECT_NEAR(integral(density, 0, 1), 1, 1e-10);
        for (const double x : {0.1, 0.37, 0.5, 0.8})
            EXPECT_NEAR(prior.cdf_unit(x), integral(density, 0, x), 1e-10) << prior.mean << " at " << x;
        EXPECT_EQ(prior.cdf_unit(0), 0);
        EXPECT_NEAR(prior.cdf_unit(1), 1, 1e-15);
    }
}

TEST(Priors, QuantileInvertsTheDistributionIntoTheTails) {
    for (const Prior& prior : many_priors()) {
        for (const double u : {1e-9, 1e-4, 0.05, 0.3, 0.5, 0.77, 0.95, 0.9999}) {
            const double x = prior.quantile_unit(u);
            ASSERT_GE(x, 0);
            ASSERT_LE(x, 1);
            // The coordinate and the standard normal behind it are rounded; what that moves the share by is
            // allowed.
            const double far =
                std::max(std::abs(lower(prior) - prior.mean), std::abs(upper(prior) - prior.mean));
            const double rounding =
                2e-15 * std::exp(prior.log_density_unit(x)) * (1 + far / (upper(prior) - lower(prior)));
            EXPECT_NEAR(prior.cdf_unit(x), u, 1e-12 * u + rounding) << prior.mean << " at " << u;
        }
        EXPECT_NEAR(prior.quantile_unit(0), 0, 1e-12);
        EXPECT_NEAR(prior.quantile_unit(1), 1, 1e-12);
    }
}

TEST(Priors, QuantilesOfTheUntruncatedNormalAreTheTabled) {
    const Prior wide{normal, 0, 1, -30, 30};
    EXPECT_NEAR(wide.from_unit(wide.quantile_unit(0.975)), 1.959963984540054, 1e-12);
    EXPECT_NEAR(wide.from_unit(wide.quantile_unit(1e-9)), -5.997807015007687, 1e-11);
    EXPECT_NEAR(wide.from_unit(wide.quantile_unit(0.5)), 0, 1e-14);
}

// Johnson, Kotz & Balakrishnan 1994, section 10.1: moments of the truncated normal, where nothing cancels in
// them.
TEST(Priors, MomentsAgreeWithTheClosedForm) {
    const auto phi = [](double z) { return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi); };
    for (const Prior& prior : {Prior{normal, 0.4, 0.2, 0.01, 0.99}, Prior{normal, 0, 1, -2, 0.5},
                               Prior{normal, 1, 2, 2, 9}, Prior{normal, 0, 1, -30, 30}}) {
        const double a = (prior.lower - prior.mean) / prior.sd, b = (prior.upper - prior.mean) / prior.sd;
        const double mass = 0.5 * (std::erfc(a / std::numbers::sqrt2) - std::erfc(b / std::numbers::sqrt2));
        const double shift = (phi(a) - phi(b)) / mass;
        const double mean = prior.mean + prior.sd * shift;
        const double sd = prior.sd * std::sqrt(1 + (a * phi(a) - b * phi(b)) / mass - shift * shift);
        const double width = prior.upper - prior.lower;
        EXPECT_NEAR(prior.mean_unit(), (mean - prior.lower) / width, 1e-11);
        EXPECT_NEAR(prior.sd_unit(), sd / width, 1e-11);
    }
    EXPECT_DOUBLE_EQ((Prior{uniform, 0, 0, 2, 7}.sd_unit()), 1 / std::sqrt(12.0));
    // Far tail: nearly exponential with rate a = 35 in the standard normal; exact to terms of 1 / a^2.
    const Prior tail{normal, 0, 1, 20, 25};
    EXPECT_NEAR(tail.mean_unit() * 5, 1.0 / 20, 3.0 / (20 * 20 * 20));
    // Narrow: all but uniform.
    EXPECT_NEAR((Prior{normal, 0, 1, -1e-4, 1e-4}.sd_unit()), 1 / std::sqrt(12.0), 1e-9);
}

TEST(Priors, DerivativeMatchesDifferences) {
    for (const Prior& prior : many_priors()) {
        for (const double x : {0.05, 0.4, 0.9}) {
            const double h = 1e-5;
            const double slope = (prior.log_density_unit(x + h) - prior.log_density_unit(x - h)) / (2 * h);
            EXPECT_NEAR(prior.log_density_derivative_unit(x), slope, 1e-6 * (1 + std::abs(slope)));
        }
    }
}

TEST(Priors, CoordinateRunsLinearlyOrInTheLogarithmBetweenTheBounds) {
    const Prior log{lognormal, 8, 1, 1e6, 1e10}, plain{normal, 0, 1, -2, 6};
    EXPECT_NEAR(log.to_unit(1e8), 0.5, 1e-15);
    EXPECT_NEAR(log.from_unit(0.25), 1e7, 1e-6);
    EXPECT_DOUBLE_EQ(plain.to_unit(0), 0.25);
    EXPECT_DOUBLE_EQ(plain.from_unit(0.75), 4);
    for (const Prior& prior : many_priors())
        for (const double x : {0.0, 0.2, 1.0}) EXPECT_NEAR(prior.to_unit(prior.from_unit(x)), x, 1e-14);
    // The median of log10 is the mean of the normal that was stated, when the truncation is symmetric.
    EXPECT_NEAR(
        (Prior{lognormal, 5, 1, 1e2, 1e8}.from_unit(Prior{lognormal, 5, 1, 1e2, 1e8}.quantile_unit(0.5))),
        1e5, 1e-6);
    EXPECT_EQ(log.log_density_unit(-0.01), -std::numeric_limits<double>::infinity());
    EXPECT_EQ(log.log_density_unit(1.01), -std::numeric_limits<double>::infinity());
}

TEST(Priors, RefuseWhatMakesNoSense) {
    const auto message = [](const Prior& prior) -> std::string {
        try {
            prior.validate();
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "";
    };
    for (const Prior& prior : many_priors()) EXPECT_EQ(message(prior), "");
    EXPECT_NE(message({uniform, 0, 0, 2, 2}).find("lower = 2"), std::string::npos);
    EXPECT_NE(message({loguniform, 0, 0, 0, 2}).find("lower = 0"), std::string::npos);
    EXPECT_NE(message({normal, 0, 0, 0, 2}).find("sd = 0"), std::string::npos);
    EXPECT_NE(message({normal, std::nan(""), 1, 0, 2}).find("mean"), std::string::npos);
    EXPECT_NE(message({normal, 0, 1, 50, 60}).find("no mass"), std::string::npos);
    EXPECT_NE(message({uniform, 0, 0, 0, INFINITY}).find("upper"), std::string::npos);
}

}  // namespace
}  // namespace loam::surrogate
