// What counts as right, as wrong and as a false alarm in the benchmark of the diagnosis.
#include <gtest/gtest.h>

#include "experiments/workflows/benchmarks/diagnosis_score.hpp"

namespace loam::experiments {
namespace {

using Names = std::vector<std::string>;

TwinTruth hiding(Names effects, double wanted = strong, bool withheld = false) {
    TwinTruth out;
    out.effects = std::move(effects);
    out.wanted = wanted;
    out.withheld = withheld;
    return out;
}

TEST(DiagnosisScore, NamesOfOneGroupAreRightTogether) {
    EXPECT_TRUE(is_right(hiding({"adhesion"}), {"named", {"capillarity", "adhesion"}}));
    EXPECT_FALSE(is_right(hiding({"adhesion"}), {"named", {"capillarity"}}));
    EXPECT_FALSE(is_right(hiding({"adhesion"}), {"ambiguous", {"adhesion"}}));
}

TEST(DiagnosisScore, WithoutAnEffectThatIsKnownNoNameIsRight) {
    EXPECT_FALSE(is_right(hiding({}, 0), {"named", {"adhesion"}}));
    EXPECT_FALSE(is_right(hiding({"adhesion"}, strong, true), {"named", {"adhesion"}}));
}

TEST(DiagnosisScore, OfTwoEffectsOneAloneMayBeNamedButNoThird) {
    const TwinTruth two = hiding({"adhesion", "seating"});
    EXPECT_TRUE(is_right(two, {"named", {"seating"}}));
    EXPECT_TRUE(is_right(two, {"named", {"seating", "adhesion"}}));
    EXPECT_FALSE(is_right(two, {"named", {"seating", "capillarity"}}));
}

TEST(DiagnosisScore, FiguresCountEveryTwinOnce) {
    const std::vector<TwinTruth> truths{hiding({}, 0),
                                        hiding({}, 0),
                                        hiding({"adhesion"}),
                                        hiding({"adhesion"}, medium),
                                        hiding({"seating"}),
                                        hiding({"seating"}, strong, true),
                                        hiding({"adhesion", "seating"})};
    const std::vector<TwinVerdict> verdicts{{"none", {}},
                                            {"ambiguous", {"seating", "adhesion"}},
                                            {"named", {"adhesion"}, 0.8},
                                            {"named", {"seating"}, 0.3},
                                            {"ambiguous", {"seating", "density_error"}},
                                            {"outside_library", {}},
                                            {"named", {"adhesion", "seating"}, 0.7}};
    const DiagnosisScore s = score(truths, verdicts);
    EXPECT_EQ(s.twins, 7);
    EXPECT_EQ(s.wrong_names, 1);
    EXPECT_EQ(std::pair(s.plain, s.false_alarms), std::pair(2, 1));
    EXPECT_EQ(std::pair(s.withheld, s.withheld_not_named), std::pair(1, 1));
    EXPECT_EQ(std::pair(s.pairs, s.pairs_rightly), std::pair(1, 1));
    EXPECT_EQ(s.named_rightly.at(strong), std::pair(1, 2));
    EXPECT_EQ(s.named_rightly.at(medium), std::pair(0, 1));
    EXPECT_EQ(s.shrinks, std::vector{0.8});
    EXPECT_EQ(s.confusion.at("none").at("ambiguous, without it"), 1);
    EXPECT_EQ(s.confusion.at("adhesion").at("seating"), 1);
    EXPECT_EQ(s.confusion.at("seating").at("ambiguous, with it"), 1);
    int counted = 0;
    for (const auto& [hidden, said] : s.confusion)
        for (const auto& [what, count] : said) counted += count;
    EXPECT_EQ(counted, s.twins);
}

}  // namespace
}  // namespace loam::experiments
