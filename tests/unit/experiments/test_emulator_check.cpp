// What direct runs say of an emulator, against emulators whose error is known.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "experiments/cross_test.hpp"
#include "experiments/emulator_check.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A model of one parameter, measured at 0.5 with specimens as small as the runs: strains
/// 0.02 (k + 1) / 6 · (1 + (x + offset) / 2), scattering by 2 % as a whole from run to run.
struct Model {
    static constexpr Index readings = 6;
    ParameterSpace space;
    Settings settings{};
    Observation observation;
    std::vector<Index> columns;
    std::mt19937_64 random{5};

    static double strain(double x, Index k) { return 0.02 * static_cast<double>(k + 1) / 6 * (1 + x / 2); }

    Model() {
        space.parameters.resize(1);
        space.fitted = {0};
        space.priors = {surrogate::Prior{surrogate::PriorKind::uniform, 0, 0, 0, 1}};
        space.values = VectorXd::Constant(1, 0.5);
        observation.measured.resize(readings);
        for (Index k = 0; k < readings; ++k) {
            observation.measured[k] = strain(0.5, k);
            columns.push_back(k);
        }
    }

    RunRecord run(double x, double offset, double scatter) {
        RunRecord out;
        out.spec.parameters = VectorXd::Constant(1, x);
        out.ok = true;
        out.outputs.resize(readings);
        const double factor = 1 + scatter * std::normal_distribution<double>()(random);
        for (Index k = 0; k < readings; ++k) out.outputs[k] = strain(x + offset, k) * factor;
        return out;
    }

    TrainedEmulator emulator(double offset, unsigned seed = 7) {
        random.seed(seed);
        std::vector<RunRecord> runs;
        for (int r = 0; r < 60; ++r) runs.push_back(run(r / 59.0, offset, 0.02));
        return train_emulator(runs, space, columns, transforms_of(observation), settings);
    }

    Fit fitted(const TrainedEmulator& trained) const { return fit(trained, space, observation, settings); }

    MatrixXd direct(double x, double scatter) {
        std::vector<RunRecord> runs;
        for (int r = 0; r < 12; ++r) runs.push_back(run(x, 0, scatter));
        return transformed_curves(runs, columns, transforms_of(observation));
    }
};

TEST(EmulatorCheck, TheShiftIsThatOfARefitWithTheErrorMended) {
    for (const unsigned seed : {7, 8, 9, 10, 11}) {
        Model model;
        const TrainedEmulator off = model.emulator(0.03, seed);
        const Fit fit = model.fitted(off);
        const double sd = std::sqrt(gaussian_of(fit, 1).covariance(0, 0));
        // Direct runs without scatter: their mean is the truth, and 0.5 what a fit without error would find.
        const double moved = (0.5 - fit.estimate[0]) / sd;
        ASSERT_GT(moved, 0.2);
        const EmulatorCheck check =
            check_emulator(fit, off, model.observation, model.direct(fit.estimate[0], 0.0));
        EXPECT_NEAR(check.shift, moved, 0.1 * moved);
        EXPECT_EQ(check.parameter, 0);
        EXPECT_DOUBLE_EQ(check.limit, 0.5);
    }
}

TEST(EmulatorCheck, WhatTheScatterOfTheRunsMakesIsAllowed) {
    Model model;
    const TrainedEmulator sound = model.emulator(0);
    const Fit fit = model.fitted(sound);
    const double x = fit.estimate[0];
    int agreeing = 0;
    for (int k = 0; k < 50; ++k)
        agreeing += check_emulator(fit, sound, model.observation, model.direct(x, 0.04)).agrees() ? 1 : 0;
    EXPECT_GE(agreeing, 42);  // 97 % expected, less what is off in the emulator itself
    // The same error is no chance where runs scatter less.
    const double limit = check_emulator(fit, sound, model.observation, model.direct(x, 0.04)).limit;
    EXPECT_GT(limit, check_emulator(fit, sound, model.observation, model.direct(x, 0.01)).limit);
    // Runs that scatter so much that they tell nothing are no agreement by that.
    EXPECT_DOUBLE_EQ(check_emulator(fit, sound, model.observation, model.direct(x, 0.5)).limit, 2);
}

TEST(EmulatorCheck, AnErrorThatMovesNoParameterIsSeenInTheCurves) {
    Model model;
    const TrainedEmulator sound = model.emulator(0);
    const Fit fit = model.fitted(sound);
    MatrixXd direct = model.direct(fit.estimate[0], 0.0);
    const EmulatorCheck before = check_emulator(fit, sound, model.observation, direct);
    EXPECT_LT(before.difference, 1);
    EXPECT_TRUE(before.agrees());
    // The error at right angles to what the parameter does, in the metric of the residuals.
    MatrixXd slope;
    sound.emulator.predict_mean(fit.estimate, &slope);
    VectorXd error = VectorXd::Zero(Model::readings);
    error[0] = 1;
    const VectorXd weights = fit.covariance.ldlt().solve(slope).col(0);
    error -= slope.col(0) * (weights.dot(error) / weights.dot(slope.col(0)));
    direct.rowwise() += error.transpose();
    const EmulatorCheck after = check_emulator(fit, sound, model.observation, direct);
    EXPECT_NEAR(after.shift, before.shift, 1e-9);
    EXPECT_GT(after.difference, 1);
    EXPECT_FALSE(after.agrees());
}

TEST(EmulatorCheck, NothingToCompareIsNoAgreement) {
    EXPECT_FALSE(EmulatorCheck{}.agrees());
}

/// A fit of two parameters whose posterior is even over 0.4 .. 0.6 in the first, 0 .. 1 in the second.
Fit posterior_about_a_half(double first, double emulator_share) {
    Fit out;
    out.estimate = Eigen::Vector2d(first, 0.5);
    out.posterior.draws.resize(201, 3);
    for (Index k = 0; k <= 200; ++k)
        out.posterior.draws.row(k) << 0.4 + 0.001 * static_cast<double>(k), 0.005 * static_cast<double>(k), 1;
    out.plausible.draws = out.posterior.draws.array() + 10;
    out.near.draws = out.posterior.draws.array() + 20;
    out.emulator_share = emulator_share;
    return out;
}

TEST(EmulatorCheck, APosteriorApartFromTheEstimateGivesWayToWhatIsPlausible) {
    const auto gives_way = [](double estimate, double emulator_share) {
        Fit fit = posterior_about_a_half(estimate, emulator_share);
        const MatrixXd draws = fit.posterior.draws;
        const Index which = bring_to_estimate(fit);
        EXPECT_EQ(fit.posterior.draws, which < 0 ? draws : fit.plausible.draws);
        return which;
    };
    EXPECT_EQ(gives_way(0.7, 0.2), 0);
    EXPECT_EQ(gives_way(0.5, 0.9), -1);
    // Outside the central 90 %, within 99 %: where the emulator is sure, that is the posterior's shape.
    EXPECT_EQ(gives_way(0.595, 0.9), 0);
    EXPECT_EQ(gives_way(0.595, 0.2), -1);
}

TEST(EmulatorCheck, SetsFarBehindTheForemostAreNotInQuestion) {
    using Places = std::vector<std::size_t>;
    EXPECT_EQ(in_question({-7}), Places({0}));
    EXPECT_EQ(in_question({-7, 3, -1.5, 2}), Places({1, 3, 2}));
    EXPECT_EQ(in_question({-7, 3, -1.7, 2}), Places({1, 3}));
    EXPECT_EQ(in_question({-4, -3, -2, -1}), Places({3, 2, 1}));
    EXPECT_EQ(in_question({-INFINITY, -INFINITY, 0}), Places({2}));
    // A set of which nothing is known but that it is impossible is still better than none.
    EXPECT_EQ(in_question({-INFINITY}), Places({0}));
}

/// How many of the sets to add are draws of the posterior, how many are near the estimate and how many
/// plausible.
std::array<int, 3> drawn(const Fit& fit, int whole, bool follows) {
    const MatrixXd sets = sets_to_add(fit, whole, follows, 3, 100);
    std::array<int, 3> out{};
    for (Index k = 0; k < sets.rows(); ++k) {
        const auto is_in = [&](const MatrixXd& draws) {
            return (draws.leftCols(2).rowwise() - sets.row(k)).rowwise().squaredNorm().minCoeff() == 0;
        };
        out[0] += is_in(fit.posterior.draws);
        out[1] += is_in(fit.near.draws);
        out[2] += is_in(fit.plausible.draws);
    }
    EXPECT_EQ(out[0] + out[1] + out[2], sets.rows());
    return out;
}

TEST(EmulatorCheck, IsSureWhereThePosteriorIsAboutTheEstimateAndNotTheEmulators) {
    EXPECT_TRUE(is_sure(posterior_about_a_half(0.5, 0.2)));
    EXPECT_TRUE(is_sure(posterior_about_a_half(0.402, tolerable_share)));
    EXPECT_FALSE(is_sure(posterior_about_a_half(0.5, 0.3)));
    EXPECT_FALSE(is_sure(posterior_about_a_half(0.7, 0)));
    EXPECT_EQ(outside_posterior(posterior_about_a_half(0.5, 1)), -1);
    EXPECT_EQ(outside_posterior(posterior_about_a_half(0.3, 0)), 0);
}

TEST(EmulatorCheck, RunsAreAddedByHowMuchOfThePosteriorIsIgnorance) {
    const Fit sure = posterior_about_a_half(0.5, 0.1), unsure = posterior_about_a_half(0.5, 1),
              astray = posterior_about_a_half(0.7, 0);
    using Numbers = std::array<int, 3>;
    for (const bool follows : {false, true}) {
        EXPECT_EQ(drawn(sure, 24, follows), Numbers({24, 0, 0}));
        EXPECT_EQ(drawn(unsure, 24, follows), Numbers({8, 8, 8}));
        EXPECT_EQ(drawn(unsure, 2, follows), Numbers({1, 1, 0}));
        EXPECT_EQ(drawn(unsure, 1, follows), Numbers({1, 0, 0}));
        EXPECT_EQ(drawn(astray, 1, follows), Numbers({1, 0, 0}));
    }
    EXPECT_EQ(drawn(astray, 24, false), Numbers({6, 9, 9}));
    EXPECT_EQ(drawn(astray, 24, true), Numbers({2, 0, 0}));
    // Others at every place, the same at the same.
    EXPECT_EQ(sets_to_add(sure, 5, false, 3, 101).topRows(4),
              sets_to_add(sure, 5, false, 3, 100).bottomRows(4));
    EXPECT_NE(sets_to_add(sure, 5, false, 4, 100), sets_to_add(sure, 5, false, 3, 100));
}

}  // namespace
}  // namespace loam::experiments
