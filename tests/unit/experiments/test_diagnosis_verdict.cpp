// When an effect is named, and when it is not.
#include <gtest/gtest.h>

#include <numeric>

#include "experiments/diagnosis/next_test.hpp"
#include "experiments/diagnosis/regions.hpp"
#include "experiments/diagnosis/verdict.hpp"

namespace loam::experiments {
namespace {

using Names = std::vector<std::string>;

Finalist finalist(const std::string& name, int group, double gain, double fit_p = 0.3) {
    Finalist f;
    f.effect = name;
    f.group = group;
    f.log_evidence = gain;
    f.held_out_gain = gain;
    f.fit_p = fit_p;
    return f;
}

TEST(DiagnosisVerdict, NoAlarmIsNoneWhateverTheCandidates) {
    EXPECT_EQ(decide(false, true, {finalist("rotation", 0, 50)}).kind, VerdictKind::none);
}

TEST(DiagnosisVerdict, NamesTheOneThatFitsAndPredicts) {
    const Verdict v = decide(true, true, {finalist("adhesion", 0, 4), finalist("rotation", 1, 50)});
    EXPECT_EQ(v.kind, VerdictKind::named);
    EXPECT_EQ(v.effects, Names{"rotation"});
}

TEST(DiagnosisVerdict, WhatExplainsLittleIsNotTriedBesideWhatFits) {
    const std::vector<Finalist> fits = {finalist("rotation", 1, 100)};
    EXPECT_TRUE(is_hopeless(19, fits));
    EXPECT_FALSE(is_hopeless(21, fits));
    EXPECT_FALSE(is_hopeless(3, {finalist("rotation", 1, 22)})) << "by too few nats";
    EXPECT_FALSE(is_hopeless(19, {finalist("rotation", 1, 100, 1e-4)})) << "which does not fit";
    EXPECT_FALSE(is_hopeless(0, {}));
}

TEST(DiagnosisVerdict, AScoreWithoutAShrinkingGapNamesNothing) {
    Finalist wider = finalist("rotation", 1, 50);
    wider.gap_shrinks = false;
    EXPECT_EQ(decide(true, true, {wider}).kind, VerdictKind::outside_library);
}

TEST(DiagnosisVerdict, WhatStillMissesTheCurvesLeftOutIsNotNamed) {
    Finalist far = finalist("cementation", 1, 50);
    far.gap = 1.8;
    EXPECT_EQ(decide(true, true, {far}).kind, VerdictKind::outside_library);
    far.gap = 1.2;
    EXPECT_EQ(decide(true, true, {far}).kind, VerdictKind::named);
}

TEST(DiagnosisVerdict, EffectsOfOneGroupAreNamedTogether) {
    Finalist simple = finalist("rotation", 1, 49);
    simple.log_evidence = 60;
    const Verdict v = decide(true, true, {finalist("rolling_resistance", 1, 50), simple});
    EXPECT_EQ(v.kind, VerdictKind::named);
    EXPECT_EQ(v.effects, (Names{"rotation", "rolling_resistance"}));
}

TEST(DiagnosisVerdict, RivalsOfOtherGroupsMakeItAmbiguous) {
    const Verdict v = decide(true, true, {finalist("adhesion", 0, 48), finalist("rotation", 1, 50)});
    EXPECT_EQ(v.kind, VerdictKind::ambiguous);
    EXPECT_EQ(v.effects, (Names{"rotation", "adhesion"}));
}

TEST(DiagnosisVerdict, WhatPredictsBetterButDoesNotFitStandsInTheWayOfAName) {
    const Finalist half = finalist("rolling_resistance", 0, 66, 1e-4);
    const Verdict v = decide(true, true, {half, finalist("density_error", 1, 63)});
    EXPECT_EQ(v.kind, VerdictKind::ambiguous);
    EXPECT_EQ(v.effects, (Names{"density_error", "rolling_resistance"}));
    EXPECT_EQ(decide(true, true, {half, finalist("density_error", 1, 70)}).kind, VerdictKind::named);
    // Of its own group it is no rival, and none where it does not predict.
    EXPECT_EQ(decide(true, true, {half, finalist("rotation", 0, 63)}).effects, Names{"rotation"});
    EXPECT_EQ(decide(true, true, {finalist("seating", 0, 4, 1e-4), finalist("rotation", 1, 8)}).kind,
              VerdictKind::named);
}

TEST(DiagnosisVerdict, AMundaneRivalIsHeardLongerAndNamedFirst) {
    Finalist seating = finalist("seating", 0, 45);
    seating.is_mundane = true;
    const Verdict v = decide(true, true, {finalist("plastic_contact", 1, 50), seating});
    EXPECT_EQ(v.kind, VerdictKind::ambiguous);
    EXPECT_EQ(v.effects, (Names{"seating", "plastic_contact"}));
    seating.held_out_gain = 43;
    EXPECT_EQ(decide(true, true, {finalist("plastic_contact", 1, 50), seating}).kind, VerdictKind::named);
    // The other way round the physics has no such privilege.
    seating.held_out_gain = 55;
    EXPECT_EQ(decide(true, true, {finalist("plastic_contact", 1, 50), seating}).effects, Names{"seating"});
}

TEST(DiagnosisVerdict, WhatDoesNotFitPredictOrStayPhysicalIsNotNamed) {
    EXPECT_EQ(decide(true, true, {finalist("rotation", 0, 50, 1e-4)}).kind, VerdictKind::outside_library);
    EXPECT_EQ(decide(true, true, {finalist("rotation", 0, 4)}).kind, VerdictKind::outside_library);
    Finalist f = finalist("rotation", 0, 50);
    f.is_physical = false;
    EXPECT_EQ(decide(true, true, {f}).kind, VerdictKind::outside_library);
    f.is_physical = true;
    f.is_present = false;
    EXPECT_EQ(decide(true, true, {f}).kind, VerdictKind::outside_library);
    EXPECT_EQ(decide(true, true, {}).kind, VerdictKind::outside_library);
}

TEST(DiagnosisVerdict, WithoutCurvesToPredictNothingIsNamed) {
    const Verdict v = decide(true, false, {finalist("rotation", 0, 50), finalist("seating", 1, 10)});
    EXPECT_EQ(v.kind, VerdictKind::ambiguous);
    EXPECT_EQ(v.effects, (Names{"rotation", "seating"}));
}

TEST(DiagnosisVerdict, ProbabilitiesSumToOneAndLeaveRoomForNoneOfThem) {
    const auto good = probabilities({finalist("a", 0, 50), finalist("b", 1, 49)});
    EXPECT_NEAR(std::accumulate(good.begin(), good.end(), 0.0), 1, 1e-12);
    EXPECT_NEAR(good[0] / good[1], std::exp(1.0), 1e-9);
    EXPECT_EQ(good.back(), 0);
    const auto bad = probabilities({finalist("a", 0, 50, 1e-5)});
    EXPECT_NEAR(bad.back(), 0.99, 1e-9);
    EXPECT_EQ(probabilities({}), std::vector<double>{1.0});
}

TEST(DiagnosisRegions, OedometerByStressAndPhase) {
    RegionCurve curve{"o.csv", "axial_strain", lab_data::TestKind::oedometer, 10, Eigen::VectorXd(7), {}, {}};
    curve.x << 1e4, 3e4, 1e5, 3e5, 1e6, 1e5, 5e5;
    curve.phase = {"loading", "loading", "loading", "loading", "loading", "unloading", "reloading"};
    const std::vector<Region> regions = regions_of(curve);
    ASSERT_EQ(regions.size(), 5u);
    EXPECT_EQ(regions[0].name, "low stress");
    EXPECT_EQ(regions[0].outputs, (std::vector<Eigen::Index>{10, 11}));
    EXPECT_EQ(regions[1].outputs, (std::vector<Eigen::Index>{12}));
    EXPECT_EQ(regions[2].outputs, (std::vector<Eigen::Index>{13, 14}));
    EXPECT_EQ(regions[3].name, "unloading");
    EXPECT_EQ(regions[4].name, "reloading");
}

TEST(DiagnosisRegions, TriaxialByPeakAndTurn) {
    RegionCurve curve{"t.csv", "deviatoric_stress", lab_data::TestKind::triaxial,
                      0,       Eigen::VectorXd(6),  Eigen::VectorXd(6),
                      {}};
    curve.x << 0.005, 0.02, 0.04, 0.1, 0.15, 0.2;
    curve.model << 1e5, 2e5, 3e5, 2.5e5, 2e5, 2e5;
    const std::vector<Region> stress = regions_of(curve);
    ASSERT_EQ(stress.size(), 4u);
    EXPECT_EQ(stress[0].name, "initial");
    EXPECT_EQ(stress[1].outputs, (std::vector<Eigen::Index>{1, 2}));
    EXPECT_EQ(stress[2].name, "softening");
    EXPECT_EQ(stress[3].name, "residual");
    curve.channel = "volumetric_strain";
    curve.model << 1e-3, 3e-3, 1e-3, -1e-3, -2e-3, -3e-3;
    const std::vector<Region> volume = regions_of(curve);
    ASSERT_EQ(volume.size(), 2u);
    EXPECT_EQ(volume[0].name, "contraction");
    EXPECT_EQ(volume[1].outputs.size(), 4u);
}

TEST(DiagnosisNextTest, MundaneRivalsAreSettledFirstAndMissingTestsAreAskedFor) {
    using lab_data::TestKind;
    MeasuredTests all{{TestKind::oedometer, TestKind::triaxial, TestKind::direct_shear}, {1e5, 2e5}, true};
    EXPECT_NE(next_test({"cementation", "seating"}, all).find("on the specimen itself"), std::string::npos);
    EXPECT_NE(next_test({}, all).find("400 kPa"), std::string::npos);
    MeasuredTests few{{TestKind::oedometer}, {}, false};
    EXPECT_NE(next_test({"rotation", "rolling_resistance"}, few).find("triaxial"), std::string::npos);
}

}  // namespace
}  // namespace loam::experiments
