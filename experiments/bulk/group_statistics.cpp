#include "experiments/bulk/group_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "experiments/bulk/precompression.hpp"
#include "experiments/quantile.hpp"
#include "surrogate/statistics/rank_tests.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using lab_data::Covariate;

constexpr std::size_t most_groups = 15, most_numbers = 8, fewest_in_group = 3, fewest_on_average = 2;
constexpr double level = 0.05;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

std::string label_of(const Covariate& covariate) {
    if (const auto* number = std::get_if<double>(&covariate)) return fmt::format("{}", *number);
    if (const auto* label = std::get_if<std::string>(&covariate)) return *label;
    return {};
}

void add_results(GroupStatistics& out, const BulkStudy& study, const ParameterSpace& space) {
    const auto n = static_cast<Index>(out.rows.size());
    for (Index p = 0; p < space.dimension(); ++p) {
        Quantity q{std::string(space.info(p).name), std::string(space.info(p).unit), VectorXd(n),
                   space.is_logarithmic(p), true};
        for (Index k = 0; k < n; ++k)
            q.values[k] = space.prior(p).from_unit(
                study.samples[out.rows[static_cast<std::size_t>(k)]].fit->estimate[p]);
        out.quantities.push_back(std::move(q));
    }
    Quantity zeta{"precompression_stress", "Pa", VectorXd(n), true, true};
    for (Index k = 0; k < n; ++k) {
        const LoadingCurve& curve = study.samples[out.rows[static_cast<std::size_t>(k)]].sample->curve;
        zeta.values[k] = precompression_stress(curve.stress, curve.strain).value_or(none);
    }
    out.quantities.push_back(std::move(zeta));
}

void add_covariates(GroupStatistics& out, const lab_data::DataSet& set) {
    for (std::size_t c = 0; c < set.covariates.size(); ++c) {
        Quantity q{set.covariates[c], "", VectorXd::Constant(static_cast<Index>(out.rows.size()), none)};
        Index present = 0;
        for (std::size_t k = 0; k < out.rows.size(); ++k)
            if (const auto* number = std::get_if<double>(&set.rows[out.rows[k]].covariates[c])) {
                q.values[static_cast<Index>(k)] = *number;
                ++present;
            }
        if (present >= 3) out.quantities.push_back(std::move(q));
    }
}

/// The groups of a covariate, by label or by rising number; empty where it does not sort samples into groups.
std::vector<Group> groups_of(const lab_data::DataSet& set, std::size_t covariate,
                             const std::vector<std::size_t>& rows) {
    std::map<std::pair<double, std::string>, Group> found;
    bool numbers = false;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Covariate& value = set.rows[rows[k]].covariates[covariate];
        const std::string label = label_of(value);
        if (label.empty()) continue;
        const auto* number = std::get_if<double>(&value);
        numbers = numbers || number != nullptr;
        Group& group = found[{number ? *number : 0.0, label}];
        group.label = label;
        group.members.push_back(static_cast<Index>(k));
    }
    std::size_t sorted = 0;
    for (const auto& [key, group] : found) sorted += group.members.size();
    // Values that hardly repeat measure the samples and do not sort them.
    const bool few = found.size() >= 2 && found.size() <= (numbers ? most_numbers : most_groups) &&
                     fewest_on_average * found.size() <= sorted;
    std::vector<Group> out;
    if (few)
        for (auto& [key, group] : found) out.push_back(std::move(group));
    return out;
}

VectorXd values_of(const Quantity& q, const Group& group) {
    return q.values(group.members);
}

/// p-value of two groups by signed ranks of the samples that `key` pairs; NaN where pairs are not unique.
double paired_p(const Quantity& q, const Group& a, const Group& b, const std::vector<std::string>& key) {
    std::map<std::string, Index> second;
    for (const Index k : b.members)
        if (!second.emplace(key[static_cast<std::size_t>(k)], k).second) return none;
    std::vector<double> x, y;
    std::map<std::string, Index> first;
    for (const Index k : a.members) {
        if (!first.emplace(key[static_cast<std::size_t>(k)], k).second) return none;
        const auto match = second.find(key[static_cast<std::size_t>(k)]);
        if (match == second.end()) continue;
        x.push_back(q.values[k]);
        y.push_back(q.values[match->second]);
    }
    const auto n = static_cast<Index>(x.size());
    return surrogate::wilcoxon_signed_rank(Eigen::Map<VectorXd>(x.data(), n),
                                           Eigen::Map<VectorXd>(y.data(), n))
        .p_value;
}

double median(const VectorXd& values) {
    std::vector<double> present;
    for (const double v : values)
        if (!std::isnan(v)) present.push_back(v);
    return present.empty() ? none : quantile(std::move(present), 0.5);
}

void compare(Grouping& grouping, const Quantity& q, const std::vector<std::string>& key) {
    std::vector<VectorXd> values, large;
    std::vector<double> medians;
    for (const Group& group : grouping.groups) {
        values.push_back(values_of(q, group));
        medians.push_back(median(values.back()));
        if (group.members.size() >= fewest_in_group) large.push_back(values.back());
    }
    grouping.medians.push_back(std::move(medians));
    grouping.kruskal_p.push_back(surrogate::kruskal_wallis(large).p_value);
    const auto g = static_cast<Index>(values.size());
    std::vector<double> p;
    for (Index i = 0; i < g; ++i)
        for (Index j = i + 1; j < g; ++j) {
            const Group &a = grouping.groups[static_cast<std::size_t>(i)],
                        &b = grouping.groups[static_cast<std::size_t>(j)];
            const double by_pairs = key.empty() ? none : paired_p(q, a, b, key);
            grouping.paired = grouping.paired || !std::isnan(by_pairs);
            p.push_back(!std::isnan(by_pairs) ? by_pairs
                                              : surrogate::mann_whitney(values[static_cast<std::size_t>(i)],
                                                                        values[static_cast<std::size_t>(j)])
                                                    .p_value);
        }
    p = surrogate::bonferroni(p);
    Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> different(g, g);
    different.setConstant(false);
    std::size_t at = 0;
    for (Index i = 0; i < g; ++i)
        for (Index j = i + 1; j < g; ++j, ++at) different(i, j) = different(j, i) = p[at] < level;
    grouping.letters.push_back(surrogate::group_letters(different));
}

}  // namespace

std::size_t GroupStatistics::results() const {
    return static_cast<std::size_t>(std::ranges::count_if(quantities, &Quantity::is_result));
}

GroupStatistics group_statistics(const BulkStudy& study, const lab_data::DataSet& set,
                                 const ParameterSpace& space, const std::string& paired_by) {
    GroupStatistics out;
    for (const SampleOutcome& s : study.samples)
        if (s.status == "calibrated") out.rows.push_back(s.row);
    add_results(out, study, space);
    add_covariates(out, set);
    std::vector<std::string> key;
    const auto pairing = std::ranges::find(set.covariates, paired_by);
    if (pairing != set.covariates.end())
        for (const std::size_t row : out.rows)
            key.push_back(label_of(
                set.rows[row].covariates[static_cast<std::size_t>(pairing - set.covariates.begin())]));
    for (std::size_t c = 0; c < set.covariates.size(); ++c) {
        Grouping grouping;
        grouping.covariate = set.covariates[c];
        grouping.groups = groups_of(set, c, out.rows);
        if (grouping.groups.empty() || set.covariates[c] == paired_by) continue;
        for (const Quantity& q : out.quantities)
            if (q.is_result) compare(grouping, q, key);
        out.groupings.push_back(std::move(grouping));
    }
    const auto n = static_cast<Index>(out.quantities.size());
    out.correlation = out.significance = Eigen::MatrixXd::Identity(n, n);
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < i; ++j) {
            const surrogate::RankTest test =
                surrogate::spearman(out.quantities[static_cast<std::size_t>(i)].values,
                                    out.quantities[static_cast<std::size_t>(j)].values);
            out.correlation(i, j) = out.correlation(j, i) = test.statistic;
            out.significance(i, j) = out.significance(j, i) = test.p_value;
        }
    return out;
}

}  // namespace loam::experiments
