// Tests that look at ranks alone, for quantities of unknown distribution. Values that are NaN are missing and
// are left out; equal values share the mean of their ranks, and variances are corrected for them.
// Sources: Hollander, Wolfe & Chicken 2014, "Nonparametric statistical methods", 3rd ed.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace loam::surrogate {

struct RankTest {
    double statistic = 0;
    double p_value = 1;  ///< two-sided; NaN where the data are too few or all equal
};

/// Ranks [n], from 1, of values without NaN.
Eigen::VectorXd ranks(const Eigen::VectorXd& values);

/// Do two or more groups come from one distribution? Statistic H with its chi-squared approximation.
RankTest kruskal_wallis(const std::vector<Eigen::VectorXd>& groups);

/// Two independent groups: statistic U of x (ties count half). Exact if one group has at most 8 values and
/// there are no ties, else normal with continuity correction.
RankTest mann_whitney(const Eigen::VectorXd& x, const Eigen::VectorXd& y);

/// Pairs (x, y): statistic the smaller of the rank sums of positive and negative differences; differences of
/// zero are left out. Exact for at most 50 differences without ties or zeros, else normal. Throws
/// std::invalid_argument if sizes differ.
RankTest wilcoxon_signed_rank(const Eigen::VectorXd& x, const Eigen::VectorXd& y);

/// Spearman's rank correlation as statistic, its significance by Student's t with n - 2 degrees of freedom.
/// Throws std::invalid_argument if sizes differ.
RankTest spearman(const Eigen::VectorXd& x, const Eigen::VectorXd& y);

/// p-values times their number, at most 1 (Bonferroni); NaN stay and do not count.
std::vector<double> bonferroni(const std::vector<double>& p_values);

/// Letters for groups that do not differ: groups i and j share one unless different(i, j). [g] of "a", "ab" …
/// Insert and absorb, Piepho 2004, J. Comput. Graph. Stat. 13, 456-466.
std::vector<std::string> group_letters(const Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>& different);

}  // namespace loam::surrogate
