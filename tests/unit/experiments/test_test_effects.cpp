// What a laboratory test adds to its specimen, against closed forms, and that strength 0 is nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "experiments/effects/model_effects.hpp"
#include "experiments/effects/run_effects.hpp"
#include "experiments/effects/test_models.hpp"

namespace loam::experiments {
namespace {

using Eigen::VectorXd;

VectorXd vector(std::initializer_list<double> values) {
    VectorXd out(static_cast<Eigen::Index>(values.size()));
    std::copy(values.begin(), values.end(), out.begin());
    return out;
}

TEST(TestModels, BeddingSaturatesAndDoesNotComeBack) {
    const VectorXd strain = bedding_strain(vector({1e4, 1e5, 1e6, 1e4}), 0.01, 5e4);
    EXPECT_NEAR(strain[0], 0.01 * (1 - std::exp(-0.2)), 1e-15);
    EXPECT_NEAR(strain[2], 0.01, 1e-10);
    EXPECT_EQ(strain[3], strain[2]);
}

TEST(TestModels, RingFrictionIsJanssensMeanAndTurnsRoundOnUnloading) {
    const double beta = 0.3, down = (1 - std::exp(-beta)) / beta, up = (std::exp(beta) - 1) / beta;
    // The mean over the height of the stress that falls as exp(-beta z), by the trapezoidal rule.
    double mean = 0;
    for (int k = 0; k <= 1000; ++k) mean += std::exp(-beta * k / 1000.0) * (k % 1000 ? 1 : 0.5) / 1000;
    EXPECT_NEAR(down, mean, 1e-7);
    const VectorXd met = mean_ring_stress(vector({1e5, 4e5, 3.9e5, 1e5, 1.2e5, 4e5}), beta, 2e3);
    EXPECT_NEAR(met[0], down * 1e5, 1e-6);
    EXPECT_NEAR(met[1], down * 4e5, 1e-6);
    EXPECT_EQ(met[2], met[1]);  // the friction lets go first
    EXPECT_NEAR(met[3], up * 1e5, 1e-6);
    EXPECT_EQ(met[4], met[3]);
    EXPECT_NEAR(met[5], down * 4e5, 1e-6);
    const VectorXd top = vector({1e5, 4e5, 1e5});
    EXPECT_EQ(mean_ring_stress(top, 0, 2e3), top);
}

TEST(TestModels, ReadingsOfAMovedCurve) {
    // y = x^2 read where 0.5 y is added to x: x' = x + 0.5 x^2.
    const Eigen::Index n = 60;
    const VectorXd x = VectorXd::LinSpaced(n, 1.0 / n, 1);
    const VectorXd y = x.cwiseAbs2();
    const VectorXd moved = at_shifted_readings(x, 0.5 * y, y);
    for (Eigen::Index k = 0; k < n; ++k) {
        const double truth = -1 + std::sqrt(1 + 2 * x[k]);
        EXPECT_NEAR(moved[k], truth * truth, 2e-4);
    }
    EXPECT_EQ(at_shifted_readings(x, VectorXd::Zero(n), y), y);
}

/// A test of that kind as a laboratory might measure it.
lab_data::Test measured_test(lab_data::TestKind kind) {
    lab_data::Test test;
    test.kind = kind;
    test.cell_pressure = test.normal_stress = 1e5;
    test.box_length = 0.06;
    test.seating_stress = 2e3;
    const bool oedometer = kind == lab_data::TestKind::oedometer;
    for (int k = 1; k <= 8; ++k) {
        test.columns["axial_stress"].push_back(k * 5e4);
        test.columns["axial_strain"].push_back(oedometer ? 2e-3 * k : 5e-3 * k);
        test.columns["deviatoric_stress"].push_back(2e5);
        test.columns["volumetric_strain"].push_back(1e-3);
        test.columns["shear_displacement"].push_back(5e-4 * k);
        test.columns["shear_stress"].push_back(5e4);
        test.columns["settlement"].push_back(1e-4);
        test.lines.push_back(k + 1);
    }
    return test;
}

class EachEffectOfTheTest : public testing::TestWithParam<std::string> {};

TEST_P(EachEffectOfTheTest, IsNothingAtStrengthZeroAndSomethingAboveIt) {
    const ModelEffect& effect = *find_model_effect(GetParam());
    Settings settings;
    settings.effects = {GetParam()};
    const TestEffects effects(settings);
    ASSERT_FALSE(effects.empty());
    const auto law = static_cast<Eigen::Index>(engine::find_law(settings.law)->parameters.size());
    bool shows = false;
    for (const LabTestKind& kind : lab_test_kinds()) {
        const lab_data::Test test = measured_test(kind.kind);
        const std::vector<std::size_t> readings = kind.readings(test);
        const SimulatedTest simulated{kind, test, readings};
        VectorXd parameters = VectorXd::Zero(law + static_cast<Eigen::Index>(effect.parameters.size()));
        for (std::size_t k = 1; k < effect.parameters.size(); ++k)
            parameters[law + static_cast<Eigen::Index>(k)] = effect.parameters[k].held;
        VectorXd plain(static_cast<Eigen::Index>(kind.channels.size() * readings.size()));
        for (Eigen::Index k = 0; k < plain.size(); ++k)
            plain[k] = 1e5 * (1 - std::exp(-0.3 * static_cast<double>(k % 8 + 1)));
        VectorXd outputs = plain;
        effects.correct(simulated, parameters, outputs);
        EXPECT_EQ(outputs, plain);
        EXPECT_EQ(effects.void_ratio_error(parameters), 0);
        EXPECT_EQ(effects.as_met(simulated, parameters).columns, test.columns);

        parameters[law] = effect.parameters[0].prior.upper;
        effects.correct(simulated, parameters, outputs);
        const lab_data::Test met = effects.as_met(simulated, parameters);
        EXPECT_EQ(kind.readings(met).size(), readings.size());
        EXPECT_TRUE(outputs.allFinite());
        const bool changed =
            outputs != plain || met.columns != test.columns || effects.void_ratio_error(parameters) != 0;
        if (effect.touches && !effect.touches(kind.kind)) {
            EXPECT_FALSE(changed);
        }
        shows = shows || changed;
    }
    EXPECT_TRUE(shows);
}

INSTANTIATE_TEST_SUITE_P(Effects, EachEffectOfTheTest,
                         testing::Values("wall_friction", "apparatus_compliance", "seating", "density_error"),
                         [](const auto& info) { return info.param; });

TEST(ModelEffects, HoldThoseOfTheEngineAndHaveOneNameEach) {
    std::set<std::string_view> names;
    for (const ModelEffect& effect : model_effects()) {
        EXPECT_TRUE(names.insert(effect.name).second) << effect.name;
        EXPECT_EQ(effect.contact != nullptr, effect.origin == EffectOrigin::contact);
        for (const engine::ParameterInfo& parameter : effect.parameters) {
            EXPECT_GE(parameter.prior.lower, parameter.lower) << parameter.name;
            EXPECT_LE(parameter.prior.upper, parameter.upper) << parameter.name;
        }
        if (!effect.parameters.empty()) {
            EXPECT_LE(effect.parameters[0].lower, 0) << effect.name;
        }
    }
    for (const engine::EffectInfo& effect : engine::effects()) EXPECT_TRUE(names.contains(effect.name));
    EXPECT_TRUE(names.contains("rotation"));
}

}  // namespace
}  // namespace loam::experiments
