// The sampler against densities whose moments are known. Tolerances are Monte-Carlo errors, four of them,
// computed from the effective sizes that the sampler itself reports: too good a report fails here too.
#include "optimizers/posterior.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <vector>

#include "optimizers/mcmc_diagnostics.hpp"
#include "test_functions.hpp"

namespace loam::optimizers {
namespace {

using testing::box;
using testing::vector;

/// A normal density with mean m, sd s and correlations r^|i - j|.
Objective normal(Eigen::Index d, double m, double s, double r) {
    Matrix covariance(d, d);
    for (Eigen::Index i = 0; i < d; ++i) {
        for (Eigen::Index j = 0; j < d; ++j)
            covariance(i, j) = s * s * std::pow(r, std::abs(static_cast<double>(i - j)));
    }
    const Matrix precision = covariance.inverse();
    return [precision, m](const Vector& x, Vector*) {
        const Vector e = x.array() - m;
        return -0.5 * e.dot(precision * e);
    };
}

double correlation(const Matrix& draws, Eigen::Index i, Eigen::Index j) {
    const Vector a = draws.col(i).array() - draws.col(i).mean(),
                 b = draws.col(j).array() - draws.col(j).mean();
    return a.dot(b) / std::sqrt(a.squaredNorm() * b.squaredNorm());
}

double least_ess(const Posterior& posterior) {
    return std::min(posterior.ess_bulk.minCoeff(), posterior.ess_tail.minCoeff());
}

void expect_converged(const Posterior& posterior, const PosteriorOptions& options = {}) {
    EXPECT_TRUE(posterior.summary.converged) << posterior.summary.stopped_by;
    EXPECT_LT(posterior.rhat.maxCoeff(), options.max_rhat);
    EXPECT_GE(least_ess(posterior), options.wanted_ess);
    EXPECT_LE(posterior.summary.evaluations, options.max_evaluations);
    EXPECT_EQ(posterior.summary.stopped_by, "R-hat and effective sizes are as wanted");
}

/// Mean and sd of variable i within four Monte-Carlo errors; the sd's error is that of a normal variable.
void expect_moments(const Posterior& posterior, Eigen::Index i, double mean, double sd) {
    const double error = sd / std::sqrt(posterior.ess_bulk(i));
    EXPECT_NEAR(posterior.mean(i), mean, 4 * error) << "variable " << i;
    EXPECT_NEAR(posterior.sd(i), sd, 4 * error / std::sqrt(2.0)) << "variable " << i;
}

/// Mean and sd of a normal variable (m, s) cut to [0, 1].
std::pair<double, double> truncated_normal(double m, double s) {
    const auto below = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
    const auto density = [](double z) { return std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi); };
    const double a = -m / s, b = (1 - m) / s, whole = below(b) - below(a);
    const double shift = (density(a) - density(b)) / whole;
    const double variance = 1 + (a * density(a) - b * density(b)) / whole - shift * shift;
    return {m + s * shift, s * std::sqrt(variance)};
}

TEST(Posterior, OfFiveCorrelatedNormals) {
    const Posterior posterior = sample_posterior(normal(5, 0.45, 0.05, 0.9), unit_cube(5));
    expect_converged(posterior);
    for (Eigen::Index i = 0; i < 5; ++i) {
        expect_moments(posterior, i, 0.45, 0.05);
        for (Eigen::Index j = 0; j < i; ++j) {
            const double r = std::pow(0.9, static_cast<double>(i - j));
            EXPECT_NEAR(correlation(posterior.draws, i, j), r,
                        4 * (1 - r * r) / std::sqrt(least_ess(posterior)));
        }
    }
    EXPECT_NEAR(quantile(posterior.draws.col(0), 0.95), 0.45 + 1.6449 * 0.05, 0.004);
    // One effective draw for three evaluations or so; local moves alone would need twenty.
    EXPECT_LE(posterior.summary.evaluations, 30000);
    EXPECT_GT(posterior.acceptance, 0.3);
    EXPECT_LT(posterior.warmup_evaluations, posterior.summary.evaluations);
}

TEST(Posterior, OfNormalsNarrowStronglyCorrelatedOrMany) {
    const Posterior narrow = sample_posterior(normal(4, 0.3, 0.002, 0.5), unit_cube(4));
    expect_converged(narrow);
    expect_moments(narrow, 1, 0.3, 0.002);
    const Posterior tight = sample_posterior(normal(3, 0.5, 0.1, 0.999), unit_cube(3));
    expect_converged(tight);
    expect_moments(tight, 2, 0.5, 0.1);
    EXPECT_NEAR(correlation(tight.draws, 0, 1), 0.999, 4 * 0.002 / std::sqrt(least_ess(tight)));
    const Posterior many = sample_posterior(normal(12, 0.5, 0.05, 0.8), unit_cube(12), {.wanted_ess = 1000});
    expect_converged(many, {.wanted_ess = 1000});
    for (Eigen::Index i = 0; i < 12; ++i) expect_moments(many, i, 0.5, 0.05);
}

TEST(Posterior, OfNothingIsUniformOnAnyBoxAndFixedVariablesStay) {
    const Bounds bounds{vector({-3, 0.25, 10, 1e-3}), vector({7, 0.25, 11, 2e-3})};
    const Posterior posterior = sample_posterior([](const Vector&, Vector*) { return -1234.5; }, bounds);
    expect_converged(posterior);
    for (const Eigen::Index i : {0, 2, 3}) {
        const double lower = bounds.lower(i), width = bounds.upper(i) - lower;
        EXPECT_NEAR(posterior.mean(i), lower + 0.5 * width,
                    4 * width / std::sqrt(12 * posterior.ess_bulk(i)));
        for (const double p : {0.05, 0.5, 0.95}) {
            const double error = std::sqrt(p * (1 - p) / least_ess(posterior));
            EXPECT_NEAR(quantile(posterior.draws.col(i), p), lower + p * width, 5 * error * width) << i;
        }
        EXPECT_GE(posterior.draws.col(i).minCoeff(), lower);
        EXPECT_LE(posterior.draws.col(i).maxCoeff(), bounds.upper(i));
    }
    EXPECT_TRUE((posterior.draws.col(1).array() == 0.25).all());
    EXPECT_EQ(posterior.rhat(1), 1);
    EXPECT_EQ(posterior.sd(1), 0);
}

TEST(Posterior, IsRightWhereABoundCutsTheDensity) {
    // Means inside, on and beyond the bounds; the shares below 0.05 check the density next to the bound
    // itself.
    for (const auto& [m, s] : {std::pair{0.1, 0.3}, {0.0, 0.1}, {-0.4, 0.3}}) {
        const Objective density = [m = m, s = s](const Vector& x, Vector*) {
            return -0.5 * (x.array() - m).square().sum() / (s * s);
        };
        const Posterior posterior = sample_posterior(density, unit_cube(3));
        expect_converged(posterior);
        const auto [mean, sd] = truncated_normal(m, s);
        const auto below = [m = m, s = s](double x) { return 0.5 * std::erfc((m - x) / s / std::sqrt(2.0)); };
        const double share = (below(0.05) - below(0)) / (below(1) - below(0));
        for (Eigen::Index i = 0; i < 3; ++i) {
            EXPECT_NEAR(posterior.mean(i), mean, 4 * sd / std::sqrt(posterior.ess_bulk(i)));
            EXPECT_NEAR(posterior.sd(i), sd, 0.04 * sd);
            const double found = (posterior.draws.col(i).array() < 0.05).cast<double>().mean();
            EXPECT_NEAR(found, share, 4 * std::sqrt(share * (1 - share) / least_ess(posterior)));
        }
    }
}

TEST(Posterior, FollowsACurvedRidge) {
    // a ~ N(0, 1), b ~ N(a^2, 0.5^2), with a = 10 (x0 - 0.5), b = 20 (x1 - 0.3): b has mean 1 and
    // variance 2.25.
    const Objective banana = [](const Vector& x, Vector*) {
        const double a = 10 * (x(0) - 0.5), b = 20 * (x(1) - 0.3);
        return -0.5 * (a * a + (b - a * a) * (b - a * a) / 0.25);
    };
    const Posterior posterior = sample_posterior(banana, unit_cube(2));
    expect_converged(posterior);
    EXPECT_NEAR(posterior.mean(0), 0.5, 4 * 0.1 / std::sqrt(posterior.ess_bulk(0)));
    EXPECT_NEAR(posterior.mean(1), 0.35, 4 * 0.075 / std::sqrt(posterior.ess_bulk(1)));
    EXPECT_NEAR(posterior.sd(0), 0.1, 0.005);
    EXPECT_NEAR(posterior.sd(1), 0.075, 0.006);
}

TEST(Posterior, FollowsAStraightRidgeThroughTheWholeBox) {
    // Only the sum of four is known: 1.2 +- 0.01. By symmetry each has mean 0.3.
    const Objective ridge = [](const Vector& x, Vector*) {
        return -0.5 * std::pow((x.sum() - 1.2) / 0.01, 2);
    };
    const Posterior posterior = sample_posterior(ridge, unit_cube(4));
    expect_converged(posterior);
    for (Eigen::Index i = 0; i < 4; ++i) {
        EXPECT_NEAR(posterior.mean(i), 0.3, 4 * posterior.sd(i) / std::sqrt(posterior.ess_bulk(i)));
    }
    const Vector sums = posterior.draws.rowwise().sum();
    EXPECT_NEAR(sums.mean(), 1.2, 0.002);
    EXPECT_NEAR(std::sqrt((sums.array() - 1.2).square().mean()), 0.01, 0.001);
}

TEST(Posterior, GivesTwoModesTheirWeights) {
    const Objective modes = [](const Vector& x, Vector*) {
        const double a = -(x.array() - 0.3).square().sum() / (2 * 0.04 * 0.04);
        const double b = -(x.array() - 0.7).square().sum() / (2 * 0.04 * 0.04);
        return std::max(a, b) + std::log(std::exp(a - std::max(a, b)) + 3 * std::exp(b - std::max(a, b)));
    };
    const Posterior posterior = sample_posterior(modes, unit_cube(4));
    expect_converged(posterior);
    const double second = (posterior.draws.col(0).array() > 0.5).cast<double>().mean();
    EXPECT_NEAR(second, 0.75, 4 * std::sqrt(0.75 * 0.25 / posterior.ess_bulk(0)));
    const double other = 0.3 * 0.25 + 0.7 * 0.75, spread = std::sqrt(0.04 * 0.04 + 0.16 * 0.75 * 0.25);
    EXPECT_NEAR(posterior.mean(3), other, 4 * spread / std::sqrt(posterior.ess_bulk(3)));
}

TEST(Posterior, LeavesAFlatDirectionUniform) {
    const Objective two_of_three = [](const Vector& x, Vector*) {
        return -0.5 * (std::pow((x(0) - 0.4) / 0.03, 2) + std::pow((x(2) - 0.6) / 0.01, 2));
    };
    const Posterior posterior = sample_posterior(two_of_three, unit_cube(3));
    expect_converged(posterior);
    expect_moments(posterior, 0, 0.4, 0.03);
    expect_moments(posterior, 2, 0.6, 0.01);
    EXPECT_NEAR(posterior.mean(1), 0.5, 4 * std::sqrt(1.0 / 12 / posterior.ess_bulk(1)));
    EXPECT_NEAR(posterior.sd(1), std::sqrt(1.0 / 12), 0.006);
    for (const double p : {0.05, 0.25, 0.75, 0.95}) {
        EXPECT_NEAR(quantile(posterior.draws.col(1), p), p,
                    5 * std::sqrt(p * (1 - p) / least_ess(posterior)));
    }
    EXPECT_NEAR(correlation(posterior.draws, 0, 1), 0, 4 / std::sqrt(least_ess(posterior)));
}

TEST(Posterior, CountsWhatIsNotANumberAsImpossible) {
    // Uniform on the triangle x0 < x1: means 1/3 and 2/3, variances 1/18.
    const Objective triangle = [](const Vector& x, Vector*) {
        return x(0) < x(1) ? 0.0 : x(0) > 0.5 ? std::nan("") : -HUGE_VAL;
    };
    const Posterior posterior = sample_posterior(triangle, unit_cube(2));
    expect_converged(posterior);
    EXPECT_TRUE((posterior.draws.col(0).array() < posterior.draws.col(1).array()).all());
    const double error = 4 * std::sqrt(1.0 / 18 / least_ess(posterior));
    EXPECT_NEAR(posterior.mean(0), 1.0 / 3, error);
    EXPECT_NEAR(posterior.mean(1), 2.0 / 3, error);
}

TEST(Posterior, ErrorsAreAsLargeAsTheEffectiveSizesSay) {
    // Over many runs the error of the mean in units of its claimed standard error is a standard normal.
    const auto [mean, sd] = truncated_normal(0.1, 0.3);
    const Objective density = [](const Vector& x, Vector*) {
        return -0.5 * (x.array() - 0.1).square().sum() / 0.09;
    };
    double sum = 0, squares = 0;
    constexpr int runs = 60;
    for (int seed = 1; seed <= runs; ++seed) {
        const Posterior posterior =
            sample_posterior(density, unit_cube(2), {.wanted_ess = 400, .seed = 1000ULL + seed});
        for (Eigen::Index i = 0; i < 2; ++i) {
            const double z = (posterior.mean(i) - mean) / (sd / std::sqrt(posterior.ess_bulk(i)));
            sum += z;
            squares += z * z;
        }
    }
    constexpr double count = 2 * runs;
    EXPECT_NEAR(sum / count, 0, 4 / std::sqrt(count));
    EXPECT_NEAR(squares / count, 1, 4 * std::sqrt(2 / count));
}

TEST(Posterior, SaysThatItsChainsDoNotMix) {
    // 6^6 narrow peaks of different heights: a few thousand evaluations cannot travel between them.
    const Objective lattice = [](const Vector& x, Vector*) {
        double sum = 0;
        for (Eigen::Index i = 0; i < x.size(); ++i) {
            sum -= 4e3 * std::pow(std::sin(6 * std::numbers::pi * x(i)), 2);
            sum += std::sin(40 * x(i) + static_cast<double>(i));
        }
        return sum;
    };
    const Posterior posterior = sample_posterior(lattice, unit_cube(6), {.max_evaluations = 12000});
    EXPECT_FALSE(posterior.summary.converged);
    EXPECT_EQ(posterior.summary.stopped_by, "max_evaluations reached");
    EXPECT_GT(posterior.rhat.maxCoeff(), 1.05);
    EXPECT_LT(least_ess(posterior), 200);
}

TEST(Posterior, HonoursItsBudget) {
    for (const int budget : {4000, 5001}) {
        int calls = 0;
        const Objective counted = [&, inner = normal(3, 0.5, 0.001, 0.5)](const Vector& x, Vector* gradient) {
            EXPECT_EQ(gradient, nullptr);
            ++calls;
            return inner(x, nullptr);
        };
        const Posterior posterior =
            sample_posterior(counted, unit_cube(3), {.wanted_ess = 1e5, .max_evaluations = budget});
        EXPECT_LE(calls, budget);
        EXPECT_GT(calls, budget - 20);
        EXPECT_EQ(posterior.summary.evaluations, calls);
        EXPECT_FALSE(posterior.summary.converged);
        EXPECT_EQ(posterior.summary.stopped_by, "max_evaluations reached");
    }
}

TEST(Posterior, HonoursItsTime) {
    const Objective slow = [inner = normal(2, 0.5, 0.1, 0.5)](const Vector& x, Vector*) {
        std::this_thread::sleep_for(std::chrono::microseconds(100));
        return inner(x, nullptr);
    };
    const Posterior posterior = sample_posterior(slow, unit_cube(2), {.wanted_ess = 1e5, .max_seconds = 0.3});
    EXPECT_FALSE(posterior.summary.converged);
    EXPECT_EQ(posterior.summary.stopped_by, "max_seconds reached");
    EXPECT_LT(posterior.summary.seconds, 3.0);
}

TEST(Posterior, RepeatsUnderASeedAlsoBesideOthers) {
    const auto once = [](std::uint64_t seed) {
        return sample_posterior(normal(3, 0.5, 0.1, 0.7), unit_cube(3), {.wanted_ess = 400, .seed = seed});
    };
    const Posterior first = once(5);
    EXPECT_EQ(first.draws, once(5).draws);
    EXPECT_NE(first.draws(0, 0), once(6).draws(0, 0));
    std::vector<Posterior> results(2);
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < 2; ++i) threads.emplace_back([&, i] { results[i] = once(5); });
    for (std::thread& thread : threads) thread.join();
    for (const Posterior& result : results) {
        EXPECT_EQ(result.draws, first.draws);
        EXPECT_EQ(result.rhat, first.rhat);
        EXPECT_EQ(result.summary.evaluations, first.summary.evaluations);
    }
}

TEST(Posterior, DoesNotDependOnTheNumberOfThreads) {
    // A density that takes longer at some places, so that threads overtake each other.
    const Objective density = [even = normal(3, 0.5, 0.1, 0.7)](const Vector& x, Vector*) {
        if (x[0] > 0.5) std::this_thread::sleep_for(std::chrono::microseconds(20));
        return even(x, nullptr);
    };
    const auto by = [&](int threads) {
        return sample_posterior(density, unit_cube(3), {.threads = threads, .wanted_ess = 400, .seed = 5});
    };
    const Posterior one = by(1);
    for (const int threads : {0, 2, 5}) {
        const Posterior several = by(threads);
        EXPECT_EQ(several.draws, one.draws);
        EXPECT_EQ(several.summary.evaluations, one.summary.evaluations);
    }
}

TEST(Posterior, HandsOverThinnedDrawsOfAllChainsWithTheirDensities) {
    const Objective density = normal(2, 0.5, 0.1, 0.3);
    const Posterior posterior =
        sample_posterior(density, unit_cube(2), {.wanted_ess = 1000, .max_draws = 333});
    ASSERT_EQ(posterior.draws.rows(), 328);  // 41 whole sweeps of 8 chains
    ASSERT_EQ(posterior.log_density.size(), 328);
    for (Eigen::Index i = 0; i < posterior.draws.rows(); ++i) {
        EXPECT_EQ(posterior.log_density(i), density(posterior.draws.row(i), nullptr));
    }
    EXPECT_NEAR(posterior.draws.col(0).mean(), posterior.mean(0), 4 * 0.1 / std::sqrt(328));
    EXPECT_EQ(sample_posterior(density, unit_cube(2), {.wanted_ess = 100, .max_draws = 3}).draws.rows(), 3);
}

TEST(Posterior, LetsExceptionsThroughAndSaysWhenThereIsNoDensity) {
    int calls = 0;
    const Objective throwing = [&](const Vector&, Vector*) {
        if (++calls == 2500) throw std::domain_error("enough");
        return 0.0;
    };
    EXPECT_THROW(sample_posterior(throwing, unit_cube(2)), std::domain_error);
    EXPECT_EQ(calls, 2500);
    const Objective throwing_aside = [](const Vector& x, Vector*) {
        if (x[0] > 0.9) throw std::domain_error("aside");
        return 0.0;
    };
    EXPECT_THROW(sample_posterior(throwing_aside, unit_cube(2), {.threads = 3}), std::domain_error);
    const Objective nowhere = [](const Vector&, Vector*) { return -HUGE_VAL; };
    try {
        sample_posterior(nowhere, unit_cube(2), {.max_evaluations = 4000});
        FAIL() << "a posterior of nothing";
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("only 0 of 2000 points"), std::string::npos) << error.what();
    }
}

TEST(Posterior, RefusesUnsoundArguments) {
    const Objective flat = [](const Vector&, Vector*) { return 0.0; };
    const auto refused = [&](const PosteriorOptions& options, const char* field) {
        try {
            sample_posterior(flat, unit_cube(2), options);
            ADD_FAILURE() << field << " was accepted";
        } catch (const std::invalid_argument& error) {
            EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
        }
    };
    refused({.chains = 1}, "chains = 1");
    refused({.wanted_ess = 20}, "wanted_ess = 20");
    refused({.max_rhat = 1}, "max_rhat = 1");
    refused({.max_evaluations = 3999}, "max_evaluations = 3999");
    refused({.max_seconds = -1}, "max_seconds = -1");
    refused({.max_draws = 0}, "max_draws = 0");
    refused({.threads = -1}, "threads = -1");
    EXPECT_THROW(sample_posterior(flat, {vector({1}), vector({0})}), std::invalid_argument);
    EXPECT_THROW(sample_posterior(flat, {vector({1}), vector({1})}), std::invalid_argument);
}

}  // namespace
}  // namespace loam::optimizers
