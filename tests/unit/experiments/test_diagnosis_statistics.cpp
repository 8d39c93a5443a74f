// The statistics of the diagnosis on linear models with normal noise, where the truth is known exactly.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "experiments/diagnosis/fingerprints.hpp"
#include "experiments/diagnosis/held_out.hpp"
#include "experiments/diagnosis/locate.hpp"
#include "experiments/diagnosis/thresholds.hpp"
#include "optimizers/random.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd normals(optimizers::Random& random, Index n) {
    VectorXd out(n);
    for (double& value : out) value = random.normal();
    return out;
}

constexpr Index readings = 12, curves = 3, m = curves * readings;

/// Three curves of twelve readings over x in (0, 1], two parameters: a level and a slope of all curves.
MatrixXd toy_jacobian() {
    MatrixXd out(m, 2);
    for (Index k = 0; k < m; ++k) {
        const double x = static_cast<double>(k % readings + 1) / readings;
        out.row(k) << 1 + 0.3 * static_cast<double>(k / readings), x;
    }
    return out;
}

/// Independent noise of measurement and noise of packings that is correlated along each curve.
MatrixXd packing_covariance() {
    MatrixXd out = MatrixXd::Zero(m, m);
    for (Index i = 0; i < m; ++i)
        for (Index j = 0; j < m; ++j)
            if (i / readings == j / readings)
                out(i, j) = 0.04 * std::exp(-std::abs(static_cast<double>(i - j)) / 4);
    return out;
}

MatrixXd toy_noise() {
    return packing_covariance() + 0.01 * MatrixXd::Identity(m, m);
}

std::vector<Region> toy_regions() {
    std::vector<Region> out;
    for (Index curve = 0; curve < curves; ++curve)
        for (Index third = 0; third < 3; ++third) {
            Region region{"test" + std::to_string(curve), "y", "third" + std::to_string(third), {}};
            for (Index k = 0; k < 4; ++k) region.outputs.push_back(curve * readings + third * 4 + k);
            out.push_back(region);
        }
    return out;
}

LinearModel toy(const VectorXd& residual, const MatrixXd& noise) {
    return {residual, toy_jacobian(), noise, VectorXd::Constant(2, 1.5)};
}

/// Residuals about the priors' mean of a soil whose parameters come from the priors.
VectorXd soil(optimizers::Random& random, const MatrixXd& root) {
    return toy_jacobian() * (1.5 * normals(random, 2)) + root * normals(random, m);
}

/// An effect that no parameter can imitate: a step in the last third of the second curve.
VectorXd step() {
    VectorXd out = VectorXd::Zero(m);
    out.segment(readings + 8, 4).setOnes();
    return out;
}

TEST(DiagnosisProjection, IsThatOfGeneralisedLeastSquaresWithPriors) {
    optimizers::Random random(3);
    const MatrixXd s = toy_noise(), j = toy_jacobian();
    const VectorXd r = soil(random, s.llt().matrixL());
    // The fit written out: (J' S^-1 J + P^-1)^-1 J' S^-1 r.
    const MatrixXd weight = s.inverse();
    const MatrixXd information = j.transpose() * weight * j + MatrixXd::Identity(2, 2) / (1.5 * 1.5);
    const VectorXd fitted = information.inverse() * (j.transpose() * weight * r);
    const Projection projection(toy(r, s));
    EXPECT_LT((projection.projected(r) - (r - j * fitted)).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_NEAR(projection.inner(r, r),
                (r - j * fitted).dot(weight * (r - j * fitted)) + fitted.squaredNorm() / (1.5 * 1.5), 1e-9);
    // What a parameter does is left over as far as its prior holds it back, and that is little here.
    EXPECT_LT(projection.norm(j.col(0)), 0.7);
    EXPECT_GT(projection.norm(step()), 3);
}

TEST(DiagnosisProjection, RefusesSizesThatDoNotFit) {
    LinearModel model = toy(VectorXd::Zero(m), toy_noise());
    model.prior_sd = VectorXd::Ones(3);
    EXPECT_THROW(Projection{model}, std::invalid_argument);
    model = toy(VectorXd::Zero(m), -toy_noise());
    EXPECT_THROW(Projection{model}, std::invalid_argument);
}

/// Alarms among soils without an effect, with the noise known, or with that of packings estimated anew for
/// each soil from `replicates` runs.
int false_alarms(int soils, double rate, int replicates, const std::vector<Direction>& directions = {}) {
    const MatrixXd root = toy_noise().llt().matrixL(), packing_root = packing_covariance().llt().matrixL();
    optimizers::Random random(17);
    LocateOptions options;
    options.false_alarm_rate = rate;
    options.draws = 1000;
    int alarms = 0;
    for (int k = 0; k < soils; ++k) {
        MatrixXd noise = toy_noise();
        if (replicates > 0) {
            MatrixXd runs(m, replicates);
            for (Index r = 0; r < replicates; ++r) runs.col(r) = packing_root * normals(random, m);
            runs.colwise() -= VectorXd(runs.rowwise().mean());
            noise = runs * runs.transpose() / (replicates - 1) + 0.01 * MatrixXd::Identity(m, m);
            options.noise_freedom = (replicates - 1) / (0.8 * 0.8);  // four fifths are estimated
        }
        options.seed = static_cast<std::uint64_t>(k);
        alarms +=
            locate(Projection(toy(soil(random, root), noise)), toy_regions(), options, directions).alarm;
    }
    return alarms;
}

TEST(DiagnosisLocate, FalseAlarmRateIsTheStatedOne) {
    // 1000 soils at 5 %: 50 alarms, binomial sd 6.9; with that of each soil's own threshold about 8.
    EXPECT_NEAR(false_alarms(1000, 0.05, 0), 50, 25);
}

TEST(DiagnosisLocate, FalseAlarmRateHoldsWithTheNoiseEstimated) {
    // 300 soils at 5 %: 15 alarms, sd 3.8.
    EXPECT_LE(false_alarms(300, 0.05, 150), 27);
    EXPECT_LE(false_alarms(300, 0.05, 60), 27);
}

/// An effect that is spread over all curves and changes its sign within every region.
VectorXd ripple() {
    VectorXd out(m);
    for (Index k = 0; k < m; ++k) out[k] = k % 2 == 0 ? 1 : -1;
    return out;
}

std::vector<Direction> three_directions() {
    VectorXd slope(m);
    for (Index k = 0; k < m; ++k) slope[k] = std::cos(0.7 * static_cast<double>(k % readings));
    return {{step(), false}, {ripple(), true}, {slope, false}};
}

TEST(DiagnosisLocate, FalseAlarmRateHoldsAlongKnownEffects) {
    EXPECT_NEAR(false_alarms(1000, 0.05, 0, three_directions()), 50, 25);
    EXPECT_LE(false_alarms(300, 0.05, 150, three_directions()), 27);
    EXPECT_LE(false_alarms(300, 0.05, 60, three_directions()), 27);
}

TEST(DiagnosisLocate, AKnownEffectShowsThoughNoRegionDoes) {
    const MatrixXd root = toy_noise().llt().matrixL();
    optimizers::Random random(9);
    int without = 0, with = 0, backwards = 0;
    for (int k = 0; k < 100; ++k) {
        const double strength = 6 / Projection(toy(VectorXd::Zero(m), toy_noise())).norm(ripple());
        const VectorXd r = soil(random, root) + strength * ripple();
        const Projection projection(toy(r, toy_noise()));
        without += locate(projection, toy_regions()).alarm;
        const Location location = locate(projection, toy_regions(), {}, {{ripple(), false}});
        with += location.alarm && location.directed[0] > location.directed_threshold;
        // An effect that can only do the opposite is no explanation.
        backwards += locate(projection, toy_regions(), {}, {{-ripple(), false}}).directed_p < 0.01;
    }
    EXPECT_LE(without, 50);
    EXPECT_GE(with, 90);
    EXPECT_EQ(backwards, 0);
}

TEST(DiagnosisLocate, FindsAStepWithItsPlaceAndSign) {
    const MatrixXd root = toy_noise().llt().matrixL();
    optimizers::Random random(5);
    int found = 0, right = 0;
    for (int k = 0; k < 100; ++k) {
        VectorXd r = soil(random, root);
        const double strength = 6 / Projection(toy(r, toy_noise())).norm(step());  // six noises: "medium"
        r -= strength * step();
        const Location location = locate(Projection(toy(r, toy_noise())), toy_regions());
        Index worst = 0;
        location.z.cwiseAbs().maxCoeff(&worst);
        found += location.alarm;
        right += location.alarm && worst == 5 && location.z[worst] < 0;
    }
    // The region's own z is a little less than six, and the threshold of nine regions is 3.4.
    EXPECT_GE(found, 85);
    EXPECT_GE(right, 85);
}

TEST(DiagnosisLocate, DetectableStrengthIsDetectedInNineOfTenSoils) {
    const MatrixXd root = toy_noise().llt().matrixL();
    optimizers::Random random(7);
    int found = 0;
    for (int k = 0; k < 400; ++k) {
        VectorXd r = soil(random, root);
        const Projection clean(toy(r, toy_noise()));
        LocateOptions options;
        options.draws = 4000;
        const Location location = locate(clean, toy_regions(), options);
        const double strength =
            detectable_strength(region_scores(clean, toy_regions()), {}, location, step());
        r += strength * step();
        found += locate(Projection(toy(r, toy_noise())), toy_regions(), options).z.cwiseAbs().maxCoeff() >
                 location.threshold;
    }
    EXPECT_NEAR(found, 360, 25);
}

TEST(DiagnosisLocate, ARegionThatTheParametersAbsorbWholeIsNoAlarm) {
    LinearModel model{VectorXd::Constant(1, 40.0), MatrixXd::Ones(1, 1), MatrixXd::Constant(1, 1, 1e-12),
                      VectorXd::Constant(1, 1e3)};
    const Location location = locate(Projection(model), {{"t", "c", "all", {0}}});
    EXPECT_EQ(location.z[0], 0);
    EXPECT_FALSE(location.alarm);
}

TEST(DiagnosisFingerprints, GroupsWhatTheTestsCannotTellApart) {
    const Projection projection(toy(VectorXd::Zero(m), toy_noise()));
    VectorXd other = VectorXd::Zero(m);
    other.segment(2 * readings, 6).setOnes();
    const VectorXd absorbed = toy_jacobian().col(0);
    const std::vector<Fingerprint> prints{
        {"step", step(), 1, false},
        {"step and what parameters can do", 2 * step() + 3 * absorbed, 1, false},
        {"step back", -step(), 1, false},
        {"step either way", -step(), 1, true},
        {"other", other, 1, false}};
    const FingerprintTable table = compare_fingerprints(projection, prints, 0.9);
    EXPECT_NEAR(table.cosines(0, 2), -1, 1e-9);
    EXPECT_GT(table.cosines(0, 1), 0.95);
    EXPECT_EQ(table.group[0], table.group[1]);
    EXPECT_EQ(table.group[0], table.group[3]);
    EXPECT_NE(table.group[0], table.group[4]);
    // A two-sided effect joins the step to its opposite; without it they are apart.
    const FingerprintTable apart = compare_fingerprints(projection, {prints[0], prints[2]}, 0.9);
    EXPECT_NE(apart.group[0], apart.group[1]);
}

// Two effects without anything in common, measured on the same few packings whose scatter is in both: the
// means' product would make them alike, and each longer than it is.
TEST(DiagnosisFingerprints, ScatterOfCommonPackingsMakesNothingAlikeOrLonger) {
    const Projection projection(toy(VectorXd::Zero(m), toy_noise()));
    VectorXd other = VectorXd::Zero(m);
    other.segment(2 * readings, 6).setOnes();
    optimizers::Random random(7);
    const double scatter = 0.8 / std::sqrt(projection.inner(VectorXd::Unit(m, 0), VectorXd::Unit(m, 0)));
    double one_square = 0, both = 0, biased = 0;
    constexpr int repeats = 2000, packings = 4;
    for (int k = 0; k < repeats; ++k) {
        EffectChange one{MatrixXd(m, packings), {1, 2, 3, 4}, packings, 0}, two = one;
        for (int p = 0; p < packings; ++p) {
            const VectorXd chance = scatter * normals(random, m);
            one.of_packing.col(p) = step() + chance;
            two.of_packing.col(p) = other + chance;
        }
        one_square += inner_product(projection, one, one) / repeats;
        both += inner_product(projection, one, two) / repeats;
        biased += projection.inner(one.mean(), two.mean()) / repeats;
    }
    EXPECT_NEAR(one_square, projection.inner(step(), step()), 0.3);
    EXPECT_NEAR(both, projection.inner(step(), other), 0.3);
    EXPECT_GT(biased, both + 2);
    // One packing that only one of them has is no reason to drop it.
    const EffectChange alone{MatrixXd(step()), {9}, 1, 0}, apart{MatrixXd(other), {8}, 1, 0};
    EXPECT_NEAR(inner_product(projection, alone, apart), projection.inner(step(), other), 1e-9);
    EXPECT_EQ(inner_product(projection, alone, alone), 0);
}

TEST(DiagnosisFingerprints, ExplainedStrengthAndSign) {
    const MatrixXd noise = 1e-6 * MatrixXd::Identity(m, m);
    const VectorXd r = 3 * step() + toy_jacobian() * Eigen::Vector2d(0.5, -1);
    const Projection projection(toy(r, noise));
    const Explained found = explain(projection, {"step", 2 * step(), 0.5, false}, 1);
    EXPECT_NEAR(found.strength, 0.75, 1e-3);  // 2 steps at 0.5: 4 steps for each unit
    EXPECT_NEAR(found.chi_squared, projection.inner(r, r), 0.2 + 1e-4 * projection.inner(r, r));
    EXPECT_EQ(explain(projection, {"back", -step(), 1, false}, 1).chi_squared, 0);
    EXPECT_LT(explain(projection, {"either", -step(), 1, true}, 1).strength, 0);
}

/// A linear model for the held-out predictions.
FittedModel linear_fitted(const VectorXd& measured, const MatrixXd& jacobian) {
    const Index d = jacobian.cols();
    return {measured, toy_noise(), VectorXd::Constant(d, 0.5), VectorXd::Constant(d, 0.3),
            [jacobian](const VectorXd& x, MatrixXd* slope) {
                if (slope) *slope = jacobian;
                return VectorXd(jacobian * x);
            }};
}

std::vector<HeldOutGroup> curve_groups() {
    std::vector<HeldOutGroup> out;
    for (Index curve = 0; curve < curves; ++curve) {
        out.push_back({"test" + std::to_string(curve), {}});
        for (Index k = 0; k < readings; ++k) out.back().outputs.push_back(curve * readings + k);
    }
    return out;
}

TEST(DiagnosisHeldOut, NoiseAloneLeavesNoGapAndAnEffectThatIsAddedClosesIt) {
    const MatrixXd root = toy_noise().llt().matrixL(), base = toy_jacobian();
    // The effect shows in all curves, so that two of them foretell the third.
    MatrixXd extended(m, 3);
    extended.leftCols(2) = base;
    for (Index k = 0; k < m; ++k) extended(k, 2) = k % readings < 4 ? 4.0 : 0.0;
    optimizers::Random random(11);
    double before = 0, after = 0, error = 0, gain = 0;
    constexpr int soils = 40;
    for (int k = 0; k < soils; ++k) {
        const VectorXd y = extended * Eigen::Vector3d(0.4, 0.6, 0.5) + root * normals(random, m);
        const VectorXd start = VectorXd::Constant(3, 0.5);
        const auto without = predict_held_out(linear_fitted(y, base), curve_groups(), start.head(2));
        const auto with = predict_held_out(linear_fitted(y, extended), curve_groups(), start);
        before += gap(without) / soils;
        after += gap(with) / soils;
        error += error_over_noise(with) / soils;
        for (std::size_t g = 0; g < with.size(); ++g)
            gain += (with[g].log_score - without[g].log_score) / soils;
        const GapInterval interval = gap_interval(without, with, 1);
        EXPECT_LE(interval.shrink_low, interval.shrink_high);
    }
    EXPECT_NEAR(error, 1, 0.15);
    // The mean square of 36 correlated errors scatters by some 0.4, of which the gap keeps the upper half's
    // root.
    EXPECT_LT(after, 0.15 * before);
    EXPECT_GT(before, 3);
    EXPECT_GT(gain, thresholds::gain_over_base);
}

TEST(DiagnosisHeldOut, ShrinkIsAShareOfTheGap) {
    EXPECT_DOUBLE_EQ(shrink_of(2, 0.5), 0.75);
    EXPECT_EQ(shrink_of(2, 0), 1);
    EXPECT_EQ(shrink_of(0, 0), 0);
    EXPECT_EQ(shrink_of(0.1, 5), -1);
    EXPECT_EQ(shrink_of(0, 1), -1);
}

TEST(DiagnosisHeldOut, ScoreIsTheConditionalDensityOfTheLinearModel) {
    optimizers::Random random(13);
    const VectorXd y =
        toy_jacobian() * Eigen::Vector2d(0.3, 0.7) + toy_noise().llt().matrixL() * normals(random, m);
    const FittedModel model = linear_fitted(y, toy_jacobian());
    const HeldOutScore score = predict_held_out(model, curve_groups(), Eigen::Vector2d(0.5, 0.5)).at(1);
    // log N(all) - log N(all but the second curve), of marginal normals.
    const MatrixXd v = toy_noise() + 0.09 * toy_jacobian() * toy_jacobian().transpose();
    const auto log_density = [&](const std::vector<Index>& used) {
        const VectorXd r = (y - toy_jacobian() * Eigen::Vector2d(0.5, 0.5))(used);
        const Eigen::LLT<MatrixXd> factor(MatrixXd(v(used, used)));
        return -0.5 *
               (r.dot(factor.solve(r)) + 2 * factor.matrixL().toDenseMatrix().diagonal().array().log().sum() +
                static_cast<double>(used.size()) * std::log(2 * M_PI));
    };
    std::vector<Index> all, others;
    for (Index k = 0; k < m; ++k) {
        all.push_back(k);
        if (k / readings != 1) others.push_back(k);
    }
    // Noise is not shared between the curves of this toy, so that the score is exact.
    EXPECT_NEAR(score.log_score, log_density(all) - log_density(others), 1e-5);
}

// Brynjarsdottir and O'Hagan 2014, "Learning about physical parameters: the importance of model discrepancy",
// section 2: a machine does work y = theta x / (1 + x / a) with theta = 0.65 and a = 20 for effort x; the
// model is y = theta x. Readings at eleven efforts from 0.2 to 4 with noise of 0.01.
TEST(DiagnosisSimpleMachine, TheDiscrepancyIsFoundWithItsSign) {
    constexpr Index n = 11;
    const VectorXd x = VectorXd::LinSpaced(n, 0.2, 4);
    std::vector<Region> regions{{"machine", "work", "low", {0, 1, 2, 3}},
                                {"machine", "work", "middle", {4, 5, 6, 7}},
                                {"machine", "work", "high", {8, 9, 10}}};
    const auto test = [&](double a, std::uint64_t seed) {
        optimizers::Random random(seed);
        const VectorXd y = 0.65 * x.array() / (1 + x.array() / a) + 0.01 * normals(random, n).array();
        const LinearModel model{y - 0.5 * x, x, 1e-4 * MatrixXd::Identity(n, n), VectorXd::Constant(1, 0.5)};
        return locate(Projection(model), regions);
    };
    int found = 0, right = 0, false_alarms = 0;
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        const Location location = test(20, seed);
        found += location.alarm;
        // Friction: the line that fits lies below the machine in the middle and above it at high effort.
        right += location.z[1] > 0 && location.z[2] < 0;
        false_alarms += test(1e9, seed).alarm;
    }
    EXPECT_EQ(found, 50);
    EXPECT_EQ(right, 50);
    EXPECT_LE(false_alarms, 2);  // 50 at 0.5 %
}

}  // namespace
}  // namespace loam::experiments
