#include "surrogate/statistics/rank_tests.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>

namespace loam::surrogate {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr Index exact_group = 8, exact_pairs = 50;

VectorXd present(const VectorXd& values) {
    std::vector<double> out;
    for (const double v : values)
        if (!std::isnan(v)) out.push_back(v);
    return Eigen::Map<VectorXd>(out.data(), static_cast<Index>(out.size()));
}

/// Sum over sets of equal values of (t^3 - t).
double tie_sum(const VectorXd& values) {
    std::vector<double> sorted(values.begin(), values.end());
    std::ranges::sort(sorted);
    double sum = 0;
    for (std::size_t i = 0; i < sorted.size();) {
        std::size_t j = i;
        while (j < sorted.size() && sorted[j] == sorted[i]) ++j;
        const auto t = static_cast<double>(j - i);
        sum += t * t * t - t;
        i = j;
    }
    return sum;
}

double two_sided(double z) {
    return 2 * boost::math::cdf(boost::math::complement(boost::math::normal(), std::abs(z)));
}

/// Share of the arrangements of n1 + n2 ranks whose U is at least u.
double mann_whitney_upper(Index n1, Index n2, double u) {
    // counts[i][k]: ways to choose i of the ranks so far with sum of (rank - place) equal to k.
    const Index most = n1 * n2;
    std::vector<std::vector<double>> counts(static_cast<std::size_t>(n1) + 1,
                                            std::vector<double>(static_cast<std::size_t>(most) + 1, 0.0));
    counts[0][0] = 1;
    for (Index rank = 1; rank <= n1 + n2; ++rank)
        for (Index i = std::min(rank, n1); i >= 1; --i)
            for (Index k = most; k >= rank - i; --k)
                counts[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] +=
                    counts[static_cast<std::size_t>(i - 1)][static_cast<std::size_t>(k - (rank - i))];
    const std::vector<double>& last = counts[static_cast<std::size_t>(n1)];
    double all = 0, upper = 0;
    for (Index k = 0; k <= most; ++k) {
        all += last[static_cast<std::size_t>(k)];
        if (static_cast<double>(k) >= u - 1e-9) upper += last[static_cast<std::size_t>(k)];
    }
    return upper / all;
}

/// Share of the 2^n signs of ranks 1..n whose positive sum is at most w.
double signed_rank_lower(Index n, double w) {
    const Index most = n * (n + 1) / 2;
    std::vector<double> share(static_cast<std::size_t>(most) + 1, 0.0);
    share[0] = 1;
    for (Index rank = 1; rank <= n; ++rank) {
        for (Index k = most; k >= 0; --k) {
            const double without = share[static_cast<std::size_t>(k)];
            const double with = k >= rank ? share[static_cast<std::size_t>(k - rank)] : 0.0;
            share[static_cast<std::size_t>(k)] = 0.5 * (without + with);
        }
    }
    double lower = 0;
    for (Index k = 0; k <= most && static_cast<double>(k) <= w + 1e-9; ++k)
        lower += share[static_cast<std::size_t>(k)];
    return lower;
}

void require_pairs(const VectorXd& x, const VectorXd& y) {
    if (x.size() != y.size()) throw std::invalid_argument("rank test: pairs differ in number");
}

}  // namespace

VectorXd ranks(const VectorXd& values) {
    std::vector<Index> order(static_cast<std::size_t>(values.size()));
    std::iota(order.begin(), order.end(), Index{0});
    std::ranges::sort(order, [&](Index a, Index b) { return values[a] < values[b]; });
    VectorXd out(values.size());
    for (std::size_t i = 0; i < order.size();) {
        std::size_t j = i;
        while (j < order.size() && values[order[j]] == values[order[i]]) ++j;
        for (std::size_t k = i; k < j; ++k) out[order[k]] = 0.5 * static_cast<double>(i + j + 1);
        i = j;
    }
    return out;
}

RankTest kruskal_wallis(const std::vector<VectorXd>& groups) {
    std::vector<double> all;
    std::vector<Index> sizes;
    for (const VectorXd& group : groups) {
        const VectorXd values = present(group);
        if (values.size() == 0) continue;
        sizes.push_back(values.size());
        all.insert(all.end(), values.begin(), values.end());
    }
    const VectorXd pooled = Eigen::Map<VectorXd>(all.data(), static_cast<Index>(all.size()));
    const auto n = static_cast<double>(pooled.size());
    const double correction = n > 1 ? 1 - tie_sum(pooled) / (n * n * n - n) : 0;
    if (sizes.size() < 2 || correction <= 0) return {nan, nan};
    const VectorXd rank = ranks(pooled);
    double sum = 0;
    Index first = 0;
    for (const Index size : sizes) {
        const double total = rank.segment(first, size).sum();
        sum += total * total / static_cast<double>(size);
        first += size;
    }
    const double h = (12 / (n * (n + 1)) * sum - 3 * (n + 1)) / correction;
    const boost::math::chi_squared chi(static_cast<double>(sizes.size() - 1));
    return {h, boost::math::cdf(boost::math::complement(chi, std::max(h, 0.0)))};
}

RankTest mann_whitney(const VectorXd& given_x, const VectorXd& given_y) {
    const VectorXd x = present(given_x), y = present(given_y);
    if (x.size() == 0 || y.size() == 0) return {nan, nan};
    VectorXd all(x.size() + y.size());
    all << x, y;
    const auto n1 = static_cast<double>(x.size()), n2 = static_cast<double>(y.size()), n = n1 + n2;
    const double u = ranks(all).head(x.size()).sum() - n1 * (n1 + 1) / 2, larger = std::max(u, n1 * n2 - u);
    const double ties = tie_sum(all);
    if (std::min(x.size(), y.size()) <= exact_group && ties == 0)
        return {u, std::min(1.0, 2 * mann_whitney_upper(std::min(x.size(), y.size()),
                                                        std::max(x.size(), y.size()), larger))};
    const double variance = n1 * n2 / 12 * (n + 1 - ties / (n * (n - 1)));
    if (!(variance > 0)) return {u, nan};
    const double z = (larger - n1 * n2 / 2 - 0.5) / std::sqrt(variance);
    return {u, std::min(1.0, z > 0 ? two_sided(z) : 1.0)};
}

RankTest wilcoxon_signed_rank(const VectorXd& x, const VectorXd& y) {
    require_pairs(x, y);
    const VectorXd all = present(x - y);
    std::vector<double> nonzero;
    for (const double d : all)
        if (d != 0) nonzero.push_back(d);
    const VectorXd d = Eigen::Map<VectorXd>(nonzero.data(), static_cast<Index>(nonzero.size()));
    if (d.size() == 0) return {nan, nan};
    const VectorXd rank = ranks(d.cwiseAbs());
    const double plus = (d.array() > 0).select(rank, 0.0).sum(), minus = rank.sum() - plus,
                 smaller = std::min(plus, minus), ties = tie_sum(d.cwiseAbs());
    if (d.size() <= exact_pairs && ties == 0 && d.size() == all.size())
        return {smaller, std::min(1.0, 2 * signed_rank_lower(d.size(), smaller))};
    const auto n = static_cast<double>(d.size());
    const double variance = n * (n + 1) * (2 * n + 1) / 24 - ties / 48;
    if (!(variance > 0)) return {smaller, nan};
    return {smaller, two_sided((smaller - n * (n + 1) / 4) / std::sqrt(variance))};
}

RankTest spearman(const VectorXd& given_x, const VectorXd& given_y) {
    require_pairs(given_x, given_y);
    std::vector<double> x, y;
    for (Index k = 0; k < given_x.size(); ++k) {
        if (std::isnan(given_x[k]) || std::isnan(given_y[k])) continue;
        x.push_back(given_x[k]);
        y.push_back(given_y[k]);
    }
    const auto n = static_cast<Index>(x.size());
    if (n < 3) return {nan, nan};
    VectorXd a = ranks(Eigen::Map<VectorXd>(x.data(), n)), b = ranks(Eigen::Map<VectorXd>(y.data(), n));
    a.array() -= a.mean();
    b.array() -= b.mean();
    const double scale = a.norm() * b.norm();
    if (!(scale > 0)) return {nan, nan};
    const double r = std::clamp(a.dot(b) / scale, -1.0, 1.0);
    if (std::abs(r) == 1) return {r, 0};
    const double freedom = static_cast<double>(n - 2), t = r * std::sqrt(freedom / ((1 - r) * (1 + r)));
    return {r, 2 * boost::math::cdf(boost::math::complement(boost::math::students_t(freedom), std::abs(t)))};
}

std::vector<double> bonferroni(const std::vector<double>& p_values) {
    const auto count =
        static_cast<double>(std::ranges::count_if(p_values, [](double p) { return !std::isnan(p); }));
    std::vector<double> out;
    for (const double p : p_values) out.push_back(std::isnan(p) ? p : std::min(1.0, count * p));
    return out;
}

std::vector<std::string> group_letters(const Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>& different) {
    const Index g = different.rows();
    std::vector<std::set<Index>> columns(1);
    for (Index i = 0; i < g; ++i) columns[0].insert(i);
    for (Index i = 0; i < g; ++i)
        for (Index j = i + 1; j < g; ++j) {
            if (!different(i, j)) continue;
            std::vector<std::set<Index>> next;
            for (const std::set<Index>& column : columns) {
                if (!column.contains(i) || !column.contains(j)) {
                    next.push_back(column);
                    continue;
                }
                for (const Index without : {i, j}) {
                    std::set<Index> part = column;
                    part.erase(without);
                    next.push_back(std::move(part));
                }
            }
            columns.clear();
            // Absorb: a column inside another says nothing.
            for (std::size_t a = 0; a < next.size(); ++a) {
                bool inside = false;
                for (std::size_t b = 0; b < next.size() && !inside; ++b)
                    inside =
                        a != b && std::ranges::includes(next[b], next[a]) && (next[b] != next[a] || b < a);
                if (!inside) columns.push_back(next[a]);
            }
        }
    std::ranges::sort(
        columns, [](const auto& a, const auto& b) { return std::ranges::lexicographical_compare(a, b); });
    std::vector<std::string> out(static_cast<std::size_t>(g));
    for (std::size_t c = 0; c < columns.size(); ++c)
        for (const Index i : columns[c]) {
            const char letter = static_cast<char>('a' + c % 26);
            out[static_cast<std::size_t>(i)] += letter;
        }
    return out;
}

}  // namespace loam::surrogate
