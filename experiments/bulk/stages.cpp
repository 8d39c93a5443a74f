#include "experiments/bulk/stages.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double same = 1e-4;  // relative: stresses that are one stage
constexpr Index cubic = 4;     // nodes of an interpolation

/// Lagrange's weights of the nodes x[first .. first + count) at `at`.
VectorXd lagrange(const VectorXd& x, Index first, Index count, double at) {
    VectorXd weight = VectorXd::Ones(count);
    for (Index i = 0; i < count; ++i)
        for (Index j = 0; j < count; ++j)
            if (j != i) weight[i] *= (at - x[first + j]) / (x[first + i] - x[first + j]);
    return weight;
}

/// Log stress of the seating stress and the stages.
VectorXd nodes(const StageSet& set) {
    VectorXd x(static_cast<Index>(set.stress.size()) + 1);
    x[0] = std::log(set.seating_stress);
    for (std::size_t k = 0; k < set.stress.size(); ++k)
        x[static_cast<Index>(k) + 1] = std::log(set.stress[k]);
    return x;
}

/// First of the nodes that interpolate at log stress `at`, and their number; a node itself is one alone.
std::pair<Index, Index> window(const VectorXd& x, double at) {
    const Index n = x.size();
    Index right = 0;
    while (right < n - 1 && x[right] < at - same) ++right;
    if (std::abs(x[right] - at) <= same) return {right, 1};
    const Index count = std::min(cubic, n);
    return {std::clamp<Index>(right - 2, 0, n - count), count};
}

}  // namespace

LoadingCurve loading_curve(const lab_data::Test& test) {
    const std::vector<double>&stress = test.column("axial_stress"), &strain = test.column("axial_strain");
    LoadingCurve curve;
    std::vector<double> x, y;
    double highest = lab_data::seating_stress(test);
    for (std::size_t k = 0; k < test.size(); ++k) {
        if (!test.phase.empty() && test.phase[k] != "loading") continue;
        if (stress[k] <= highest * (1 + same)) continue;
        highest = stress[k];
        curve.readings.push_back(k);
        x.push_back(stress[k]);
        y.push_back(strain[k]);
    }
    curve.stress = Eigen::Map<VectorXd>(x.data(), static_cast<Index>(x.size()));
    curve.strain = Eigen::Map<VectorXd>(y.data(), static_cast<Index>(y.size()));
    return curve;
}

MatrixXd StageSet::interpolation(const VectorXd& at) const {
    const VectorXd x = nodes(*this);
    MatrixXd out = MatrixXd::Zero(at.size(), static_cast<Index>(stress.size()));
    for (Index k = 0; k < at.size(); ++k) {
        const auto [first, count] = window(x, std::log(at[k]));
        const VectorXd weight = lagrange(x, first, count, std::log(at[k]));
        for (Index i = 0; i < count; ++i)
            if (first + i > 0) out(k, first + i - 1) = weight[i];  // at the seating stress strain is zero
    }
    return out;
}

Index StageSet::needed(double highest) const {
    const auto [first, count] = window(nodes(*this), std::log(highest));
    return first + count - 1;
}

StageSet common_stages(const lab_data::DataSet& set, int most) {
    StageSet out;
    std::set<double> stresses;
    bool any = false;
    for (const lab_data::DataSetRow& row : set.rows) {
        if (!row.readable()) continue;
        const lab_data::Test& test = std::get<lab_data::Test>(row.test);
        const LoadingCurve curve = loading_curve(test);
        if (curve.stress.size() == 0) continue;
        const double seat = lab_data::seating_stress(test);
        out.seating_stress = any ? std::min(out.seating_stress, seat) : seat;
        any = true;
        stresses.insert(curve.stress.begin(), curve.stress.end());
    }
    if (!any)
        throw lab_data::UserError({.file = set.folder.string(),
                                   .constraint = "has no sample with a loading stage that could be read",
                                   .remedy = "see loam check"});
    for (const double s : stresses)
        if (out.stress.empty() || s > out.stress.back() * (1 + same)) out.stress.push_back(s);
    if (static_cast<int>(out.stress.size()) <= most) return out;
    const double low = out.stress.front(), ratio = out.stress.back() / low;
    out.stress.clear();
    for (int k = 0; k < most; ++k) out.stress.push_back(low * std::pow(ratio, k / (most - 1.0)));
    return out;
}

}  // namespace loam::experiments
