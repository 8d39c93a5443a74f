// Rank tests against SciPy (rank_tests_reference.py makes the numbers), and letters of groups.
#include "surrogate/statistics/rank_tests.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rank_tests_expected.hpp"

using namespace loam::surrogate;
using Eigen::VectorXd;

namespace {

VectorXd v(const std::vector<double>& values) {
    return Eigen::Map<const VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

void expect(const RankTest& got, const expected::Case& wanted) {
    EXPECT_NEAR(got.statistic, wanted.statistic, 1e-9 * (1 + std::abs(wanted.statistic)));
    EXPECT_NEAR(got.p_value, wanted.p_value, 1e-9 * (1e-3 + wanted.p_value));
}

}  // namespace

using namespace expected;

TEST(RankTests, MannWhitneyIsSciPys) {
    expect(mann_whitney(v(plain_x), v(plain_y)), mann_whitney_plain);
    expect(mann_whitney(v(ties_x), v(ties_y)), mann_whitney_ties);
    expect(mann_whitney(v(small), v(plain_y)), mann_whitney_small);
    expect(mann_whitney(v(long_x), v(long_y)), mann_whitney_long);
    expect(mann_whitney(v(missing), v(plain_y)), mann_whitney_missing);
}

TEST(RankTests, WilcoxonIsSciPys) {
    expect(wilcoxon_signed_rank(v(plain_x), v(plain_y)), wilcoxon_plain);
    expect(wilcoxon_signed_rank(v(ties_x), v(ties_y)), wilcoxon_ties);
    expect(wilcoxon_signed_rank(v(long_x), v(long_y)), wilcoxon_long);
    expect(wilcoxon_signed_rank(v(missing), v(plain_y)), wilcoxon_missing);
}

TEST(RankTests, KruskalWallisIsSciPys) {
    expect(kruskal_wallis({v(plain_x), v(plain_y), v(small)}), kruskal_plain);
    expect(kruskal_wallis({v(ties_x), v(ties_y), v(small)}), kruskal_ties);
    expect(kruskal_wallis({v(missing), v(ties_x), v(plain_y)}), kruskal_missing);
}

TEST(RankTests, SpearmanIsSciPys) {
    expect(spearman(v(plain_x), v(plain_y)), spearman_plain);
    expect(spearman(v(ties_x), v(ties_y)), spearman_ties);
    expect(spearman(v(long_x), v(long_y)), spearman_long);
    expect(spearman(v(missing), v(plain_y)), spearman_missing);
}

TEST(RankTests, DataThatSayNothingGiveNoPValue) {
    EXPECT_TRUE(std::isnan(mann_whitney(VectorXd(), v(small)).p_value));
    EXPECT_TRUE(std::isnan(mann_whitney(VectorXd::Ones(9), VectorXd::Ones(12)).p_value));
    EXPECT_TRUE(std::isnan(wilcoxon_signed_rank(v(small), v(small)).p_value));
    EXPECT_TRUE(std::isnan(kruskal_wallis({v(small), VectorXd()}).p_value));
    EXPECT_TRUE(std::isnan(spearman(VectorXd::Ones(5), VectorXd::LinSpaced(5, 0, 1)).p_value));
    EXPECT_THROW(spearman(v(small), v(plain_x)), std::invalid_argument);
}

TEST(RankTests, BonferroniCountsThePValuesThereAre) {
    const auto p = bonferroni({0.01, expected::nan, 0.5});
    EXPECT_DOUBLE_EQ(p[0], 0.02);
    EXPECT_TRUE(std::isnan(p[1]));
    EXPECT_DOUBLE_EQ(p[2], 1);
}

TEST(RankTests, GroupsShareALetterUnlessTheyDiffer) {
    Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> different(4, 4);
    different.setConstant(false);
    const auto mark = [&](int i, int j) { different(i, j) = different(j, i) = true; };
    EXPECT_EQ(group_letters(different), std::vector<std::string>(4, "a"));
    mark(0, 2);
    mark(0, 3);
    mark(1, 3);
    const auto letters = group_letters(different);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            const bool share = letters[static_cast<std::size_t>(i)].find_first_of(
                                   letters[static_cast<std::size_t>(j)]) != std::string::npos;
            EXPECT_EQ(share, !different(i, j)) << i << j;
        }
    EXPECT_EQ(letters, (std::vector<std::string>{"a", "ab", "bc", "c"}));
}
