#include "optimizers/mcmc_diagnostics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "optimizers/normal.hpp"

namespace loam::optimizers {

namespace {

/// Each chain cut into halves: [n / 2 x 2 c]; the middle draw of an odd number is left out.
Matrix halved(const Matrix& chains) {
    const Eigen::Index half = chains.rows() / 2;
    Matrix halves(half, 2 * chains.cols());
    halves << chains.topRows(half), chains.bottomRows(half);
    return halves;
}

/// Normal scores of the ranks over all chains; ties get their average rank (Blom 1958).
Matrix rank_normalised(const Matrix& chains) {
    const auto count = static_cast<std::size_t>(chains.size());
    std::vector<Eigen::Index> order(count);
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    const double* value = chains.data();
    std::sort(order.begin(), order.end(),
              [value](Eigen::Index a, Eigen::Index b) { return value[a] < value[b]; });
    Matrix scores(chains.rows(), chains.cols());
    for (std::size_t first = 0, last = 0; first < count; first = last) {
        while (last < count && value[order[last]] == value[order[first]]) ++last;
        const double rank = 0.5 * static_cast<double>(first + 1 + last);
        const double score = normal_quantile((rank - 0.375) / (static_cast<double>(count) + 0.25));
        for (std::size_t i = first; i < last; ++i) scores.data()[order[i]] = score;
    }
    return scores;
}

/// Gelman & Rubin's statistic of the columns as they are.
double plain_rhat(const Matrix& chains) {
    const auto n = static_cast<double>(chains.rows());
    const Eigen::RowVectorXd means = chains.colwise().mean();
    const double between =
        (means.array() - means.mean()).square().sum() / static_cast<double>(chains.cols() - 1);
    const double within =
        (chains.rowwise() - means).squaredNorm() / (static_cast<double>(chains.cols()) * (n - 1));
    if (!(within > 0)) {  // constant chains: of one value, or stuck at different ones
        return between > 0 ? std::numeric_limits<double>::infinity()
                           : std::numeric_limits<double>::quiet_NaN();
    }
    return std::sqrt((n - 1) / n + between / within);
}

/// Effective number of draws for the mean, of chains that are already halved.
double size_of_halves(const Matrix& chains) {
    const Eigen::Index n = chains.rows();
    const double draws = static_cast<double>(n), total = static_cast<double>(chains.size());
    const Eigen::RowVectorXd means = chains.colwise().mean();
    const Matrix centred = chains.rowwise() - means;
    const auto autocovariance = [&](Eigen::Index lag) {
        return centred.topRows(n - lag).cwiseProduct(centred.bottomRows(n - lag)).sum() / total;
    };
    const double within = autocovariance(0) * draws / (draws - 1);
    const double between =
        (means.array() - means.mean()).square().sum() / static_cast<double>(means.size() - 1);
    const double variance = autocovariance(0) + between;
    if (!(variance > 0)) return std::numeric_limits<double>::quiet_NaN();
    const auto correlation = [&](Eigen::Index lag) { return 1 - (within - autocovariance(lag)) / variance; };
    // Sums of neighbouring pairs are positive and fall with the lag; where the estimate does not, it is
    // noise.
    double pair = 1 + correlation(1), sum = 0;
    for (Eigen::Index lag = 0; pair > 0;) {
        sum += pair;
        lag += 2;
        if (lag + 1 >= n) break;
        pair = std::min(pair, correlation(lag) + correlation(lag + 1));
    }
    const double time = std::max(2 * sum - 1, 1 / std::log10(total));
    return total / time;
}

Matrix below(const Matrix& chains, double threshold) {
    return (chains.array() <= threshold).cast<double>().matrix();
}

}  // namespace

double split_rhat(const Matrix& chains) {
    const Matrix halves = halved(chains);
    const double median = quantile(halves.reshaped(), 0.5);
    const Matrix folded = (halves.array() - median).abs();
    const double location = plain_rhat(rank_normalised(halves)), spread = plain_rhat(rank_normalised(folded));
    // Folding makes two values at equal distance from the median one constant, which says nothing about the
    // spread.
    return std::isnan(spread) ? location : std::max(location, spread);
}

double effective_size(const Matrix& chains) {
    return size_of_halves(halved(chains));
}

double bulk_effective_size(const Matrix& chains) {
    return size_of_halves(rank_normalised(halved(chains)));
}

double tail_effective_size(const Matrix& chains) {
    const Matrix halves = halved(chains);
    const Vector sample = halves.reshaped();
    const double low = size_of_halves(below(halves, quantile(sample, 0.05)));
    const double high = size_of_halves(below(halves, quantile(sample, 0.95)));
    return std::isnan(high) ? high : std::min(low, high);
}

double quantile(Vector sample, double p) {
    const double position = p * static_cast<double>(sample.size() - 1);
    const auto low = static_cast<Eigen::Index>(position);
    const auto nth = sample.begin() + low;
    std::nth_element(sample.begin(), nth, sample.end());
    if (low + 1 >= sample.size()) return *nth;
    const double next = *std::min_element(nth + 1, sample.end());
    return *nth + (position - static_cast<double>(low)) * (next - *nth);
}

Vector quantiles(const Matrix& draws, double p) {
    Vector result(draws.cols());
    for (Eigen::Index j = 0; j < draws.cols(); ++j) result(j) = quantile(draws.col(j), p);
    return result;
}

}  // namespace loam::optimizers
