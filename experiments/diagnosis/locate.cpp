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

/// The three statistics of the test.
struct Statistics {
    double largest = 0, omnibus = 0, directed = 0;
};

/// Scores of the regions and, behind them, of the directions.
class ScoreTest {
  public:
    ScoreTest(const MatrixXd& correlation, Index regions, const std::vector<Direction>& directions)
        : regions_(regions),
          directions_(directions),
          combinations_(independent_combinations(correlation.topLeftCorner(regions, regions))) {
        const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation);
        std::vector<Index> kept;
        for (Index k = 0; k < correlation.rows(); ++k)
            if (eigen.eigenvalues()[k] > least_eigenvalue) kept.push_back(k);
        root_ = eigen.eigenvectors()(Eigen::all, kept) * eigen.eigenvalues()(kept).cwiseSqrt().asDiagonal();
    }

    Statistics of(const VectorXd& z) const {
        return {largest(z), (combinations_.transpose() * z.head(regions_)).squaredNorm(), directed(z)};
    }

    /// Of scores of the model itself, judged as if their covariance were known, or by an estimate of their
    /// own each.
    std::vector<Statistics> draw_null(const LocateOptions& options) const {
        const Index n = root_.cols();
        const double freedom = std::max(options.noise_freedom, static_cast<double>(n) + fewest_spare);
        optimizers::Random random(options.seed);
        std::vector<Statistics> out;
        VectorXd normals(n);
        for (int k = 0; k < options.draws; ++k) {
            for (double& value : normals) value = random.normal();
            const VectorXd z = root_ * normals;
            out.push_back(options.noise_freedom > 0
                              ? judged_by_estimate(z, estimated_identity(random, n, freedom))
                              : of(z));
        }
        return out;
    }

  private:
    double largest(const VectorXd& z) const {
        return regions_ > 0 ? z.head(regions_).cwiseAbs().maxCoeff() : 0.0;
    }
    double directed(const VectorXd& z) const {
        double out = 0;
        for (std::size_t k = 0; k < directions_.size(); ++k) {
            const double value = z[regions_ + static_cast<Index>(k)];
            out = std::max(out, directions_[k].two_sided ? std::abs(value) : value);
        }
        return out;
    }
    /// `factor`: of the estimate of the identity that stands for the scores' covariance.
    Statistics judged_by_estimate(const VectorXd& z, const MatrixXd& factor) const {
        const MatrixXd estimate = root_ * factor;
        const VectorXd scaled = z.cwiseQuotient(estimate.rowwise().norm().cwiseMax(1e-3));
        const MatrixXd spread = combinations_.transpose() * estimate.topRows(regions_);
        const VectorXd independent = combinations_.transpose() * z.head(regions_);
        // Combinations that say nothing are zero in all.
        const MatrixXd covariance =
            spread * spread.transpose() + least_eigenvalue * MatrixXd::Identity(spread.rows(), spread.rows());
        return {largest(scaled), independent.dot(covariance.ldlt().solve(independent)), directed(scaled)};
    }

    Index regions_;
    const std::vector<Direction>& directions_;
    MatrixXd combinations_, root_;
};

/// The sorted values of one statistic.
std::vector<double> sorted(const std::vector<Statistics>& draws, double Statistics::*which) {
    std::vector<double> out;
    for (const Statistics& draw : draws) out.push_back(draw.*which);
    std::ranges::sort(out);
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

MatrixXd direction_scores(const Projection& projection, const std::vector<Direction>& directions) {
    LinearModel model = projection.model();
    model.noise.diagonal() *= 1 + thresholds::directed_ridge;
    const Projection robust(std::move(model));
    MatrixXd out = MatrixXd::Zero(static_cast<Index>(directions.size()), projection.size());
    for (std::size_t k = 0; k < directions.size(); ++k) {
        const VectorXd row = robust.weights(directions[k].change);
        const double sd = std::sqrt(projection.covariance_of(row.transpose())(0, 0));
        if (sd > 0) out.row(static_cast<Index>(k)) = row.transpose() / sd;
    }
    return out;
}

Location locate(const Projection& projection, const std::vector<Region>& regions,
                const LocateOptions& options, const std::vector<Direction>& directions) {
    const auto n = static_cast<Index>(regions.size()), d = static_cast<Index>(directions.size());
    MatrixXd scores(n + d, projection.size());
    scores << region_scores(projection, regions), direction_scores(projection, directions);
    const VectorXd all = scores * projection.model().residual;
    Location out;
    out.z = all.head(n);
    out.directed = all.tail(d);
    if (n + d == 0) return out;
    const ScoreTest test(projection.covariance_of(scores), n, directions);
    const Statistics found = test.of(all);
    out.omnibus = found.omnibus;

    const std::vector<Statistics> null = test.draw_null(options);
    const std::vector<double> largest = sorted(null, &Statistics::largest),
                              omnibus = sorted(null, &Statistics::omnibus),
                              directed = sorted(null, &Statistics::directed);
    out.largest_z_p = share_above(largest, found.largest);
    out.omnibus_p = share_above(omnibus, found.omnibus);
    if (d > 0) out.directed_p = share_above(directed, found.directed);
    const auto smallest_p = [&](const Statistics& s) {
        const double p = std::min(share_above(largest, s.largest), share_above(omnibus, s.omnibus));
        return d > 0 ? std::min(p, share_above(directed, s.directed)) : p;
    };
    std::vector<double> smallest;
    for (const Statistics& draw : null) smallest.push_back(smallest_p(draw));
    std::ranges::sort(smallest);
    const double mine = std::min({out.largest_z_p, out.omnibus_p, out.directed_p});
    const auto below = std::ranges::upper_bound(smallest, mine) - smallest.begin();
    const auto draws = static_cast<double>(smallest.size());
    out.p_value = (static_cast<double>(below) + 1) / (draws + 1);
    // The p value of one statistic alone at which the whole test raises its alarm, and what is there.
    const double critical = smallest[static_cast<std::size_t>(options.false_alarm_rate * draws)];
    const auto at = std::min(smallest.size() - 1, static_cast<std::size_t>((1 - critical) * draws));
    out.threshold = largest[at];
    out.directed_threshold = directed[at];
    out.alarm = out.p_value <= options.false_alarm_rate;
    return out;
}

double detectable_strength(const MatrixXd& scores, const VectorXd& direction, const Location& location,
                           const VectorXd& change) {
    double least = std::numeric_limits<double>::infinity();
    const auto shows = [&](double threshold, double score) {
        if (score > 0) least = std::min(least, (threshold + thresholds::detection_quantile) / score);
    };
    shows(location.threshold, (scores * change).cwiseAbs().maxCoeff());
    if (direction.size() > 0) shows(location.directed_threshold, direction.dot(change));
    return least;
}

}  // namespace loam::experiments
