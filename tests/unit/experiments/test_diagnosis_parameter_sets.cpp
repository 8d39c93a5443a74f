// Sets of parameters by each kind of test alone, on linear models where the truth is known exactly.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/diagnosis/parameter_sets.hpp"
#include "optimizers/random.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index half = 8, m = 2 * half;
constexpr double noise = 0.02;

/// Two tests that share a level and a slope; the effect bends the second alone.
MatrixXd slopes(bool with_effect) {
    MatrixXd out = MatrixXd::Zero(m, with_effect ? 3 : 2);
    for (Index k = 0; k < m; ++k) {
        const double x = static_cast<double>(k % half + 1) / half;
        out(k, 0) = k < half ? 1 : 0.7;
        out(k, 1) = k < half ? x : -0.4 * x;
        if (with_effect && k >= half) out(k, 2) = x * x;
    }
    return out;
}

FittedModel model_of(const VectorXd& measured, bool with_effect) {
    const MatrixXd jacobian = slopes(with_effect);
    const Index d = jacobian.cols();
    return {measured, MatrixXd(noise * noise * MatrixXd::Identity(m, m)), VectorXd::Constant(d, 0.5),
            VectorXd::Constant(d, 0.15), [jacobian](const VectorXd& x, MatrixXd* slope) {
                if (slope) *slope = jacobian;
                return VectorXd(jacobian * x);
            }};
}

std::vector<HeldOutGroup> tests() {
    std::vector<HeldOutGroup> out{{"first", {}}, {"second", {}}};
    for (Index k = 0; k < m; ++k) out[k < half ? 0 : 1].outputs.push_back(k);
    return out;
}

VectorXd measured(optimizers::Random& random, const Eigen::Vector3d& truth) {
    VectorXd out = slopes(true) * truth;
    for (double& value : out) value += noise * random.normal();
    return out;
}

ComparedSets compared(const VectorXd& curve, bool with_effect) {
    const FittedModel model = model_of(curve, with_effect);
    return compare_groups(model, tests(), model.prior_mean).at(0);
}

TEST(DiagnosisParameterSets, SetsOfOneSoilDisagreeAsOftenAsStated) {
    optimizers::Random random(5);
    int alarms = 0;
    constexpr int soils = 2000;
    for (int k = 0; k < soils; ++k)
        alarms += compared(measured(random, {0.45, 0.6, 0}), false).agreement.p_value < 0.05 ? 1 : 0;
    // Five standard deviations of the count.
    EXPECT_NEAR(alarms, 0.05 * soils, 5 * std::sqrt(soils * 0.05 * 0.95));
}

TEST(DiagnosisParameterSets, AnEffectThatIsMissingPartsTheSetsAndAddedBringsThemTogether) {
    optimizers::Random random(6);
    const VectorXd curve = measured(random, {0.45, 0.6, 0.4});
    const ComparedSets without = compared(curve, false), with = compared(curve, true);
    EXPECT_EQ(without.first, "first");
    EXPECT_EQ(without.second, "second");
    EXPECT_NEAR(without.of_first[0], 0.45, 0.05);
    EXPECT_GT((without.of_second - without.of_first).cwiseAbs().maxCoeff(), 0.15);
    EXPECT_LT(without.agreement.p_value, 1e-6);
    EXPECT_GT(with.agreement.p_value, 0.01);
    EXPECT_NEAR(with.of_second[2], 0.4, 0.1);
}

TEST(DiagnosisParameterSets, EveryPairIsComparedAndOneGroupMakesNone) {
    const FittedModel model = model_of(VectorXd::Constant(m, 0.5), false);
    std::vector<HeldOutGroup> groups = tests();
    groups.push_back({"third", {0, half}});
    const std::vector<ComparedSets> pairs = compare_groups(model, groups, model.prior_mean);
    ASSERT_EQ(pairs.size(), 3U);
    EXPECT_EQ(pairs[2].first + pairs[2].second, "secondthird");
    EXPECT_TRUE(compare_groups(model, {groups[0]}, model.prior_mean).empty());
}

}  // namespace
}  // namespace loam::experiments
