// What the likelihood is told of the readings: their scales, the misfit's correlation along a curve,
// specimens.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "experiments/lab_tests/triaxial.hpp"
#include "experiments/likelihood_terms.hpp"
#include "experiments/observation.hpp"
#include "lab_data/sample.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A curve of n readings of the same value whose misfit is correlated.
Observation even_curve(Index n) {
    Observation o;
    o.measured = VectorXd::Constant(n, 0.1);
    ObservedCurve curve;
    curve.count = n;
    curve.transform = OutputTransform{1, true};
    curve.along = VectorXd::LinSpaced(n, 0, 1);
    o.curves = {curve};
    return o;
}

TEST(Observation, ALinearTransformKeepsTheSign) {
    const OutputTransform t{0.01, true};
    EXPECT_DOUBLE_EQ(t.forward(-0.02), -2);
    EXPECT_DOUBLE_EQ(t.inverse(-2), -0.02);
    EXPECT_DOUBLE_EQ(t.derivative(-0.02), 100);
}

TEST(Observation, ManyReadingsOfACurveWeighNoMoreThanEnough) {
    const auto information = [](Index n) {  // on a shift of the whole curve
        const Observation o = even_curve(n);
        MatrixXd c = MatrixXd::Zero(n, n);
        ReadingNoise(o, transforms_of(o)).add(VectorXd::Constant(1, 0.01), c);
        return VectorXd::Ones(n).dot(c.llt().solve(VectorXd::Ones(n)));
    };
    EXPECT_GT(information(10), information(4));
    EXPECT_NEAR(information(400) / information(10), 1, 0.1);
}

TEST(Observation, PlacesFollowTheStrainGoneThroughBackAndForth) {
    const VectorXd rising = places_along(VectorXd{{0.01, 0.04, 0.16}});
    EXPECT_TRUE(rising.isApprox(VectorXd{{0.25, 0.5, 1}}));
    const VectorXd unloading = places_along(VectorXd{{0.04, 0.12, 0.1, 0.08}});
    EXPECT_TRUE(unloading.isApprox(VectorXd{{0.5, std::sqrt(0.75), std::sqrt(0.875), 1}}));
    EXPECT_TRUE(places_along(VectorXd::Zero(2)).isZero(0));
}

TEST(Observation, TheMisfitOfStrainsIsCorrelatedAlongThemselves) {
    Observation strains = even_curve(3), given = strains;
    strains.measured = given.measured = VectorXd{{0.02, 0.08, 0.06}};
    strains.curves[0].along.resize(0);
    strains.curves[0].phases = {0, 2};
    given.curves[0].along = places_along(given.measured);
    const auto covariance = [](const Observation& o) {
        MatrixXd c = MatrixXd::Zero(3, 3);
        ReadingNoise(o, transforms_of(o)).add(VectorXd::Constant(1, 0.01), c);
        return c;
    };
    EXPECT_EQ(covariance(strains), covariance(given));
    EXPECT_GT(covariance(strains)(1, 2), covariance(strains)(0, 1));
}

TEST(Observation, ReboundIsComparedFromWhereItBegins) {
    // Independent in loading; from there on the sum of the error at the end of the phase before and one anew.
    Observation strains = even_curve(6);
    strains.measured << 0.1, 0.2, 0.1, 0.0, 0.1, 0.2;
    strains.curves[0].along.resize(0);
    strains.curves[0].phases = {0, 2, 4};
    const auto covariance = [&](double misfit) {
        MatrixXd c = MatrixXd::Zero(6, 6);
        ReadingNoise(strains, transforms_of(strains), StrainMisfit::nearest)
            .add(VectorXd::Constant(1, misfit), c);
        return c;
    };
    MatrixXd sum(6, 6);       // of independent errors
    sum << 1, 0, 0, 0, 0, 0,  //
        0, 1, 0, 0, 0, 0,     //
        0, 1, 1, 0, 0, 0,     //
        0, 1, 0, 1, 0, 0,     //
        0, 1, 0, 1, 1, 0,     //
        0, 1, 0, 1, 0, 1;
    const MatrixXd misfit = covariance(0.01) - covariance(0);
    const VectorXd sd = misfit.diagonal().cwiseSqrt(),
                   expected_sd = (sum * sum.transpose()).diagonal().cwiseSqrt();
    for (Index i = 0; i < 6; ++i)
        for (Index j = 0; j < 6; ++j)
            EXPECT_NEAR(misfit(i, j) / (sd[i] * sd[j]),
                        (sum * sum.transpose())(i, j) / (expected_sd[i] * expected_sd[j]), 1e-9);
    EXPECT_GT(misfit(0, 0), 0);
}

TEST(Observation, ReboundCountsByTheStrainItGoesThrough) {
    // What a reading of unloading may differ by, since that began, over what one of loading may: in variance
    // the strain that leads to a reading of loading over that to one of unloading, but 1 to 100.
    const auto of_unloading = [](const VectorXd& strain) {
        Observation o = even_curve(5);
        o.measured = strain;
        o.curves[0].along.resize(0);
        o.curves[0].phases = {0, 3};
        MatrixXd some = MatrixXd::Zero(5, 5), none = some;
        const ReadingNoise noise(o, transforms_of(o), StrainMisfit::nearest);
        noise.add(VectorXd::Constant(1, 0.01), some);
        noise.add(VectorXd::Zero(1), none);
        const MatrixXd c = some - none;
        EXPECT_NEAR(c(4, 3), c(2, 2), 1e-12);
        EXPECT_NEAR(c(4, 4), c(3, 3), 1e-12);
        return (c(3, 3) - c(2, 2)) / c(0, 0);
    };
    EXPECT_NEAR(of_unloading(VectorXd{{0.01, 0.04, 0.09, 0.087, 0.081}}), 0.03 / 0.0045, 1e-6);
    EXPECT_NEAR(of_unloading(VectorXd{{0.01, 0.02, 0.03, 0.02, 0.00}}), 1, 1e-6);
    EXPECT_NEAR(of_unloading(VectorXd{{0.01, 0.02, 0.03, 0.03, 0.03}}), 100, 1e-6);
}

TEST(Observation, EveryPhaseCountsByItsOwnStrain) {
    Observation o = even_curve(6);
    o.measured = VectorXd{{0.03, 0.06, 0.055, 0.05, 0.052, 0.054}};
    o.curves[0].along.resize(0);
    o.curves[0].phases = {0, 2, 4};
    MatrixXd some = MatrixXd::Zero(6, 6), none = some;
    const ReadingNoise noise(o, transforms_of(o), StrainMisfit::nearest);
    noise.add(VectorXd::Constant(1, 0.01), some);
    noise.add(VectorXd::Zero(1), none);
    const MatrixXd c = (some - none) / (some - none)(0, 0);
    EXPECT_NEAR(c(3, 3) - c(1, 1), 0.03 / 0.005, 1e-6);
    EXPECT_NEAR(c(4, 4) - c(3, 3), 0.03 / 0.002, 1e-6);
    EXPECT_NEAR(c(5, 5) - c(3, 3), 0.03 / 0.002, 1e-6);
}

TEST(Observation, SpecimensShareNoPackingNoise) {
    Observation o = even_curve(4);
    ObservedCurve half = o.curves[0];
    half.count = 2;
    half.along = Eigen::Vector2d(0, 1);
    ObservedCurve other = half;
    other.first = 2;
    o.curves = {half, other};
    const MatrixXd noise = MatrixXd::Constant(4, 4, 3.0);
    EXPECT_EQ(ReadingNoise(o, transforms_of(o)).of_specimens(noise), noise);  // two channels of one test
    o.curves[1].test = 1;
    const MatrixXd apart = ReadingNoise(o, transforms_of(o)).of_specimens(noise);
    EXPECT_EQ(apart(0, 1), 3);
    EXPECT_EQ(apart(2, 3), 3);
    EXPECT_TRUE(apart.topRightCorner(2, 2).isZero(0));
}

TEST(TriaxialReadings, AreFewWellSpreadAndHoldThePeak) {
    const lab_data::Sample sand =
        lab_data::read_sample(std::string(LOAM_SOURCE_DIR) + "/lab_data/sets/dobrany_sand");
    for (const lab_data::Test& test : sand.tests) {
        if (test.kind != lab_data::TestKind::triaxial) continue;
        const std::vector<std::size_t> used = triaxial_readings(test);
        const auto &strain = test.column("axial_strain"), &stress = test.column("deviatoric_stress");
        EXPECT_GE(used.size(), 12u);
        EXPECT_LE(used.size(), 16u);
        double before = 0, peak = 0;
        for (const std::size_t k : used) {
            EXPECT_GT(strain[k], before);
            before = strain[k];
            peak = std::max(peak, stress[k]);
        }
        EXPECT_EQ(peak, *std::ranges::max_element(stress));
        EXPECT_LT(strain[used.front()], 0.01 * strain[used.back()]);
        EXPECT_GE(before, 0.99 * *std::ranges::max_element(strain));
    }
}

}  // namespace
}  // namespace loam::experiments
