#include "experiments/diagnosis/locate.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/diagnosis/thresholds.hpp"
#include "optimizers/random.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Below this share of a region's noise, what the fit leaves of it is rounding.
constexpr double absorbed = 1e-4;
// Regions that say the same thing twice count once.
constexpr double least_eigenvalue = 1e-6;
// An estimated covariance of n scores needs at least so many degrees of freedom more than n.
constexpr double fewest_spare = 5;

/// [regions x k]: z' T T' z is the sum of the squares of the independent combinations of the regions' scores.
MatrixXd independent_combinations(const MatrixXd& correlation) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation);
    MatrixXd out = eigen.eigenvectors();
    for (Index k = 0; k < out.cols(); ++k) {
        const double value = eigen.eigenvalues()[k];
        out.col(k) *= value > least_eigenvalue ? 1 / std::sqrt(value) : 0;
    }
    return out;
}

/// Chi-squared over its degrees of freedom (Wilson and Hilferty 1931).
double chi_squared_ratio(optimizers::Random& random, double freedom) {
    const double a = 2 / (9 * freedom);
    return std::pow(std::max(0.05, 1 - a + std::sqrt(a) * random.normal()), 3);
}

/// Lower factor A [n x n] of an estimate A A' of the identity with so many degrees of freedom (Bartlett
/// 1933).
MatrixXd estimated_identity(optimizers::Random& random, Index n, double freedom) {
    MatrixXd out = MatrixXd::Zero(n, n);
    for (Index i = 0; i < n; ++i) {
        const double own = freedom - static_cast<double>(i);
        out(i, i) = std::sqrt(own / freedom * chi_squared_ratio(random, own));
        for (Index j = 0; j < i; ++j) out(i, j) = random.normal() / std::sqrt(freedom);
    }
    return out;
}

/// Share of the sorted draws that is at least as large.
double share_above(const std::vector<double>& sorted, double value) {
    const auto at = std::ranges::lower_bound(sorted, value);
    return static_cast<double>(sorted.end() - at) / static_cast<double>(sorted.size());
}

struct NullDraws {
    std::vector<double> largest, omnibus;  // in the order of drawing
};

/// Scores z of the correlation given, judged as if it were known, or by an estimate of its own each.
NullDraws draw_null(const MatrixXd& correlation, const LocateOptions& options) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation);
    std::vector<Index> kept;
    for (Index k = 0; k < correlation.rows(); ++k)
        if (eigen.eigenvalues()[k] > least_eigenvalue) kept.push_back(k);
    const MatrixXd root =
        eigen.eigenvectors()(Eigen::all, kept) * eigen.eigenvalues()(kept).cwiseSqrt().asDiagonal();
    const auto n = static_cast<Index>(kept.size());
    const double freedom = std::max(options.noise_freedom, static_cast<double>(n) + fewest_spare);
    optimizers::Random random(options.seed);
    NullDraws out;
    VectorXd normals(n);
    for (int k = 0; k < options.draws; ++k) {
        for (double& value : normals) value = random.normal();
        VectorXd z = root * normals, independent = normals;
        if (options.noise_freedom > 0) {
            const MatrixXd factor = estimated_identity(random, n, freedom);
            const VectorXd sd = (root * factor).rowwise().norm().cwiseMax(1e-3);
            z = z.cwiseQuotient(sd);
            independent = factor.triangularView<Eigen::Lower>().solve(normals);
        }
        out.largest.push_back(n > 0 ? z.cwiseAbs().maxCoeff() : 0);
        out.omnibus.push_back(independent.squaredNorm());
    }
    return out;
}

}  // namespace

MatrixXd region_scores(const Projection& projection, const std::vector<Region>& regions) {
    const MatrixXd& noise = projection.model().noise;
    MatrixXd out = MatrixXd::Zero(static_cast<Index>(regions.size()), projection.size());
    for (std::size_t k = 0; k < regions.size(); ++k) {
        VectorXd weight = VectorXd::Zero(projection.size());
        for (const Index at : regions[k].outputs) weight[at] = 1 / std::sqrt(noise(at, at));
        const VectorXd row = projection.projected_weights(weight);
        const double left = std::sqrt(projection.covariance_of(row.transpose())(0, 0));
        if (left > absorbed * std::sqrt(weight.dot(noise * weight)))
            out.row(static_cast<Index>(k)) = row.transpose() / left;
    }
    return out;
}

Location locate(const Projection& projection, const std::vector<Region>& regions,
                const LocateOptions& options) {
    const MatrixXd scores = region_scores(projection, regions);
    Location out;
    out.z = scores * projection.model().residual;
    if (regions.empty()) return out;
    const MatrixXd correlation = projection.covariance_of(scores);
    const MatrixXd combinations = independent_combinations(correlation);
    out.omnibus = (combinations.transpose() * out.z).squaredNorm();

    const NullDraws null = draw_null(correlation, options);
    std::vector<double> largest = null.largest, omnibus = null.omnibus;
    std::ranges::sort(largest);
    std::ranges::sort(omnibus);
    out.largest_z_p = share_above(largest, out.z.cwiseAbs().maxCoeff());
    out.omnibus_p = share_above(omnibus, out.omnibus);
    const double smaller = std::min(out.largest_z_p, out.omnibus_p);
    int below = 0;
    for (std::size_t k = 0; k < null.largest.size(); ++k)
        below +=
            std::min(share_above(largest, null.largest[k]), share_above(omnibus, null.omnibus[k])) <= smaller;
    out.p_value = (below + 1.0) / (static_cast<double>(null.largest.size()) + 1);
    const auto at =
        static_cast<std::size_t>((1 - options.false_alarm_rate) * static_cast<double>(largest.size()));
    out.threshold = largest[std::min(at, largest.size() - 1)];
    out.alarm = out.p_value <= options.false_alarm_rate;
    return out;
}

double detectable_strength(const MatrixXd& scores, const Location& location, const VectorXd& change) {
    const double most = (scores * change).cwiseAbs().maxCoeff();
    if (!(most > 0)) return std::numeric_limits<double>::infinity();
    return (location.threshold + thresholds::detection_quantile) / most;
}

}  // namespace loam::experiments
