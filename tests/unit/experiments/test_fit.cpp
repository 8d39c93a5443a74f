// The scale on which curves are compared, and fits through an emulator of known curves.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "experiments/fit.hpp"
#include "experiments/quantile.hpp"

namespace loam::experiments {
namespace {

Observation up_to(double largest) {
    Observation o;
    o.measured = Eigen::Vector3d(0.1 * largest, largest, 0.5 * largest);
    return o;
}

TEST(OutputTransform, ScaleFollowsTheMeasuredCurve) {
    EXPECT_DOUBLE_EQ(transform_for(up_to(0.002)).scale, 1e-3);
    EXPECT_DOUBLE_EQ(transform_for(up_to(0.0159)).scale, 1e-3);
    EXPECT_DOUBLE_EQ(transform_for(up_to(0.0161)).scale, 4e-3);
    EXPECT_DOUBLE_EQ(transform_for(up_to(0.106)).scale, 1.6e-2);
    // Never above a quarter of the largest value, nor sixteen times below it.
    for (double y = 0.005; y < 0.6; y *= 1.1) {
        const double scale = transform_for(up_to(y)).scale;
        EXPECT_LE(4 * scale, y);
        EXPECT_GT(16 * scale, y);
    }
}

TEST(OutputTransform, InverseAndDerivativeBelongToForward) {
    const OutputTransform t{4e-3};
    for (const double y : {0.0, 1e-5, 0.003, 0.2}) {
        EXPECT_NEAR(t.inverse(t.forward(y)), y, 1e-15 + 1e-12 * y);
        const double h = 1e-7;
        EXPECT_NEAR(t.derivative(y), (t.forward(y + h) - t.forward(y - h)) / (2 * h), 1e-5 * t.derivative(y));
    }
    // Linear below the scale: the mean of two collapsed and two standing packings is kept to a tenth.
    const double mean = (0.0004 + 0.0004 + 0.0030 + 0.0034) / 4;
    double sum = 0;
    for (const double y : {0.0004, 0.0004, 0.0030, 0.0034}) sum += t.forward(y) / 4;
    EXPECT_NEAR(t.inverse(sum), mean, 0.15 * mean);
}

/// A model of one parameter whose curves bend by 0.3 sin(7 x), known from runs with x < 0.45 alone, which
/// scatter by 1 %.
struct HalfKnown {
    static constexpr Eigen::Index readings = 6;
    ParameterSpace space;
    Settings settings;
    Observation observation;
    std::vector<RunRecord> runs;
    std::vector<Eigen::Index> columns;

    static double strain(double x, Eigen::Index k) { return bent(0.3 * std::sin(7 * x), k) * (1 + 0.2 * x); }
    static double bent(double bend, Eigen::Index k) {
        return 0.02 * static_cast<double>(k + 1) / static_cast<double>(readings) *
               (1 + (k < readings / 2 ? -bend : bend));
    }

    HalfKnown() {
        settings = Settings{};
        space.parameters.resize(1);
        space.fitted = {0};
        space.priors = {surrogate::Prior{surrogate::PriorKind::uniform, 0, 0, 0, 1}};
        space.values = Eigen::VectorXd::Constant(1, 0.5);
        std::mt19937_64 random(11);
        std::normal_distribution<double> normal;
        for (int r = 0; r < 40; ++r) {
            RunRecord run;
            run.spec.parameters = Eigen::VectorXd::Constant(1, 0.45 * r / 39);
            run.ok = true;
            run.outputs.resize(readings);
            for (Eigen::Index k = 0; k < readings; ++k)
                run.outputs[k] = strain(run.spec.parameters[0], k) * (1 + 0.01 * normal(random));
            runs.push_back(run);
        }
        for (Eigen::Index k = 0; k < readings; ++k) columns.push_back(k);
    }
};

TEST(Fit, FindsTheParameterAndCoversIt) {
    HalfKnown given;
    given.observation.measured.resize(HalfKnown::readings);
    for (Eigen::Index k = 0; k < HalfKnown::readings; ++k)
        given.observation.measured[k] = HalfKnown::strain(0.3, k);
    const TrainedEmulator trained = train_emulator(given.runs, given.space, given.columns,
                                                   transforms_of(given.observation), given.settings);
    const Fit found = fit(trained, given.space, given.observation, given.settings);
    EXPECT_NEAR(found.estimate[0], 0.3, 0.03);
    const Eigen::VectorXd draws = found.posterior.draws.col(0);
    EXPECT_NEAR(quantile({draws.begin(), draws.end()}, 0.5), 0.3, 0.05);
}

TEST(Fit, IsNotDrawnToWhereTheEmulatorKnowsNothing) {
    // No parameter bends the curve so much.
    HalfKnown given;
    given.observation.measured.resize(HalfKnown::readings);
    for (Eigen::Index k = 0; k < HalfKnown::readings; ++k)
        given.observation.measured[k] = HalfKnown::bent(0.5, k);
    const TrainedEmulator trained = train_emulator(given.runs, given.space, given.columns,
                                                   transforms_of(given.observation), given.settings);
    const Fit found = fit(trained, given.space, given.observation, given.settings);
    // The emulator excludes nothing beyond the runs, and with all of its variance that would be the
    // likeliest.
    const Eigen::VectorXd beyond = Eigen::VectorXd::Constant(1, 0.85);
    EXPECT_GT((trained.emulator.predict_components(beyond).variance.array() /
               trained.emulator.typical_variance().array())
                  .maxCoeff(),
              50);
    Eigen::Index densest = 0;
    found.posterior.log_density.maxCoeff(&densest);
    EXPECT_NEAR(found.posterior.draws(densest, 0), 0.22, 0.1);
    EXPECT_NEAR(found.estimate[0], 0.22, 0.1);
    EXPECT_GT(found.misfits[0], 1e-3);
}

double share_beyond_the_runs(const optimizers::Posterior& p) {
    return static_cast<double>((p.draws.col(0).array() > 0.45).count()) / static_cast<double>(p.draws.rows());
}

TEST(Fit, IgnoranceCountsAgainstAnEstimate) {
    // Curves that the emulator's mean repeats beyond the runs. Measured is its mean there to the digit, so
    // that a search by the mean curve ends where nothing is known.
    HalfKnown given;
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    for (RunRecord& run : given.runs)
        for (Eigen::Index k = 0; k < HalfKnown::readings; ++k)
            run.outputs[k] =
                HalfKnown::bent(0.3 * std::sin(12 * run.spec.parameters[0]), k) * (1 + 0.01 * normal(random));
    given.observation.measured = given.runs.front().outputs;
    const TrainedEmulator trained = train_emulator(given.runs, given.space, given.columns,
                                                   transforms_of(given.observation), given.settings);
    for (const double unknown : {0.50, 0.52, 0.55}) {
        const Eigen::VectorXd flattering =
            trained.emulator.predict_mean(Eigen::VectorXd::Constant(1, unknown));
        for (Eigen::Index k = 0; k < HalfKnown::readings; ++k)
            given.observation.measured[k] =
                trained.transforms[static_cast<std::size_t>(k)].inverse(flattering[k]);
        ASSERT_GT(plausible_window(trained, given.space, given.observation, given.settings).upper[0],
                  unknown);
        const Fit found = fit(trained, given.space, given.observation, given.settings);
        EXPECT_LT(found.estimate[0], 0.45);
        // Nor are runs near the estimate made there as often as those of the posterior.
        EXPECT_GT(share_beyond_the_runs(found.posterior), 0.2);
        EXPECT_LT(share_beyond_the_runs(found.near), 0.8 * share_beyond_the_runs(found.posterior));
    }
}

TEST(Fit, ThePosteriorStaysWhereParametersArePlausible) {
    // So far from any curve of the model's that what the emulator leaves open beyond the runs attracts:
    // without the window some draws lie at 0.9.
    HalfKnown given;
    given.observation.measured.resize(HalfKnown::readings);
    for (Eigen::Index k = 0; k < HalfKnown::readings; ++k)
        given.observation.measured[k] = HalfKnown::bent(1.2, k);
    const TrainedEmulator trained = train_emulator(given.runs, given.space, given.columns,
                                                   transforms_of(given.observation), given.settings);
    const Window window = plausible_window(trained, given.space, given.observation, given.settings);
    EXPECT_LT(window.upper[0], 0.9);
    const Fit found = fit(trained, given.space, given.observation, given.settings);
    EXPECT_LE(found.posterior.draws.col(0).maxCoeff(), window.upper[0]);
    EXPECT_GE(found.posterior.draws.col(0).minCoeff(), window.lower[0]);
}

TEST(Fit, TheEstimateIsNearestThoughAnOffsetWouldBeMoreProbable) {
    // Measured is the model's curve at 0.4 and a constant more, which a misfit that is correlated along the
    // curve explains at 0.4, though a steeper curve is nearer.
    HalfKnown given;
    const auto curve_at = [](double x, Eigen::Index k) {
        return 0.01 * static_cast<double>(k + 1) * (1 + x);
    };
    constexpr double offset = 0.008;
    given.observation.measured.resize(HalfKnown::readings);
    double nearest = 0, squares = 0;
    for (Eigen::Index k = 0; k < HalfKnown::readings; ++k) {
        given.observation.measured[k] = curve_at(0.4, k) + offset;
        const double slope = curve_at(1, k) - curve_at(0, k);
        nearest += offset * slope;
        squares += slope * slope;
    }
    nearest = 0.4 + nearest / squares;
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    for (RunRecord& run : given.runs) {
        run.spec.parameters *= 2;
        for (Eigen::Index k = 0; k < HalfKnown::readings; ++k)
            run.outputs[k] = curve_at(run.spec.parameters[0], k) * (1 + 0.01 * normal(random));
    }
    ObservedCurve curve;
    curve.count = HalfKnown::readings;
    curve.phases = {0};
    given.observation.curves = {curve};
    const TrainedEmulator trained = train_emulator(given.runs, given.space, given.columns,
                                                   transforms_of(given.observation), given.settings);
    const Fit found = fit(trained, given.space, given.observation, given.settings);
    EXPECT_NEAR(found.estimate[0], nearest, 0.015);
    EXPECT_GT(found.near.draws.col(0).mean(), 0.5 * (nearest + 0.4));
}

TEST(Fit, OfSetsThatWereTriedTheOneWhoseRunsAreNearestIsTheMostProbable) {
    HalfKnown given;
    given.observation.measured.resize(HalfKnown::readings);
    for (Eigen::Index k = 0; k < HalfKnown::readings; ++k)
        given.observation.measured[k] = HalfKnown::strain(0.3, k);
    const std::vector<OutputTransform> transforms = transforms_of(given.observation);
    const TrainedEmulator trained =
        train_emulator(given.runs, given.space, given.columns, transforms, given.settings);
    // Where the emulator knows nothing: direct runs do, and they alone are asked.
    const auto with_curve_of = [&](double x) {
        TriedSet set{Eigen::VectorXd::Constant(1, 0.9), Eigen::VectorXd(HalfKnown::readings), 12};
        for (Eigen::Index k = 0; k < HalfKnown::readings; ++k)
            set.mean[k] = transforms[static_cast<std::size_t>(k)].forward(HalfKnown::strain(x, k));
        return set;
    };
    Fit found = fit(trained, given.space, given.observation, given.settings);
    const Eigen::MatrixXd draws = found.posterior.draws;
    const auto chosen = [&](std::vector<double> curves) {
        std::vector<TriedSet> sets;
        for (const double x : curves) sets.push_back(with_curve_of(x));
        return choose(found, sets, trained, given.space, given.observation, given.settings);
    };
    EXPECT_EQ(chosen({0.27, 0.3, 0.33}), 1u);
    EXPECT_EQ(chosen({0.6, 0.33}), 1u);
    EXPECT_LT(found.misfits[0], 1e-3);
    EXPECT_EQ(chosen({0.6}), 0u);
    EXPECT_GT(found.misfits[0], 1e-3);
    EXPECT_EQ(found.estimate[0], 0.9);
    EXPECT_EQ(found.posterior.draws, draws);
    EXPECT_THROW(chosen({}), std::invalid_argument);
}

TEST(Fit, OfSetsThatWereTriedTheNearestIsTakenThoughItsErrorsAlternate) {
    // A misfit that is correlated along the curve makes a constant offset the more probable.
    HalfKnown given;
    given.observation.measured.resize(HalfKnown::readings);
    for (Eigen::Index k = 0; k < HalfKnown::readings; ++k)
        given.observation.measured[k] = HalfKnown::strain(0.3, k);
    ObservedCurve curve;
    curve.count = HalfKnown::readings;
    curve.phases = {0};
    given.observation.curves = {curve};
    const std::vector<OutputTransform> transforms = transforms_of(given.observation);
    const TrainedEmulator trained =
        train_emulator(given.runs, given.space, given.columns, transforms, given.settings);
    const auto off_by = [&](double even, double odd) {
        TriedSet set{Eigen::VectorXd::Constant(1, 0.3), Eigen::VectorXd(HalfKnown::readings), 12};
        for (Eigen::Index k = 0; k < HalfKnown::readings; ++k)
            set.mean[k] = transforms[static_cast<std::size_t>(k)].forward(given.observation.measured[k] +
                                                                          (k % 2 == 0 ? even : odd));
        return set;
    };
    Fit found = fit(trained, given.space, given.observation, given.settings);
    EXPECT_EQ(choose(found, {off_by(0.003, 0.003), off_by(0.002, -0.002)}, trained, given.space,
                     given.observation, given.settings),
              1u);
}

}  // namespace
}  // namespace loam::experiments
