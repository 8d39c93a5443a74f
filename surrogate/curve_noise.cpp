#include "surrogate/curve_noise.hpp"

#include <algorithm>
#include <cmath>

namespace loam::surrogate {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double least_eigenvalue = 0.05;  // of a correlation matrix
constexpr double steepest_slope = 8;   // a noise that varies by more than e^8 over an input is not believed
constexpr double least_level = 1e-12;  // of a score that never changes
constexpr double least_variance_ratio = 0.1;  // moments, being unbiased, may even be negative

VectorXd noise_factor(const MatrixXd& inputs, const VectorXd& slope) {
    return ((inputs.array() - 0.5).matrix() * slope).array().exp();
}

// Rows of the groups' values [g x k] repeated for each run, [n x k].
MatrixXd for_each_run(const ReplicateGroups& groups, const MatrixXd& values) {
    return values(groups.group, Eigen::all);
}

Index emulated(const NoiseEvidence& evidence) {
    return static_cast<Index>(evidence.processes.size());
}

// Noise variance of the mean of each input's runs, in the system of one process.
VectorXd noise_of_means(const NoiseEvidence& evidence, const GaussianProcess& process) {
    return process.system().noise.cwiseQuotient(evidence.groups.count);
}

// Variances of scores [n x k] about zero, drawn to their mean.
VectorXd shrunk_variances(const MatrixXd& scores) {
    const double rows = static_cast<double>(scores.rows()), columns = static_cast<double>(scores.cols());
    const VectorXd variance = scores.colwise().squaredNorm().transpose() / (rows - 1);
    const double mean = variance.mean();
    // Were all true variances equal, the principal components of a sample would still spread by this much.
    const double chance = mean * mean * columns / rows;
    const double spread = (variance.array() - mean).square().mean();
    const double share = spread > chance ? chance / spread : 1.0;
    return ((1 - share) * variance.array() + share * mean).cwiseMax(least_level);
}

// Variance [m] of each score at the centre of the cube.
VectorXd noise_levels(const NoiseEvidence& evidence, const VectorXd& slope) {
    const Index m = evidence.scores.cols(), q = emulated(evidence), d = slope.size();
    VectorXd level(m);
    for (Index j = 0; j < q; ++j)
        level(j) = evidence.processes[static_cast<std::size_t>(j)].noise_variance(VectorXd::Constant(d, 0.5));
    if (q == m) return level;
    const MatrixXd sd =
        for_each_run(evidence.groups, noise_factor(evidence.groups.inputs, slope).cwiseSqrt());
    level.tail(m - q) =
        shrunk_variances(sd.col(0).cwiseInverse().asDiagonal() * evidence.scores.rightCols(m - q));
    return level;
}

// Sums of products of standardised residuals, and what they would be, per unit of correlation: their freedom.
struct Moments {
    MatrixXd products, freedom;
};

Moments residual_moments(const NoiseEvidence& evidence, const MatrixXd& sd) {
    const Index m = evidence.scores.cols(), q = emulated(evidence), g = evidence.groups.size();
    MatrixXd residuals = evidence.groups.means(evidence.scores);
    residuals.array() *= evidence.groups.count.cwiseSqrt().array().replicate(1, m) / sd.array();
    // Residuals of a process with noise V and Q of gp_likelihood.hpp: r = V^1/2 Q y, so that correlated noise
    // alone gives E[r_j . r_k] = correlation * tr(A_j A_k) with A = V^1/2 Q V^1/2; A is the identity where
    // nothing was fitted.
    MatrixXd freedom = MatrixXd::Constant(m, m, static_cast<double>(g));
    std::vector<MatrixXd> reach;
    for (Index j = 0; j < q; ++j) {
        const GaussianProcess& process = evidence.processes[static_cast<std::size_t>(j)];
        const GaussianProcessSystem& system = process.system();
        const VectorXd root = noise_of_means(evidence, process).cwiseSqrt();
        residuals.col(j) = system.alpha.cwiseProduct(root);
        MatrixXd lower;
        system.q_matrix(lower);
        const MatrixXd matrix = lower.selfadjointView<Eigen::Lower>();
        reach.push_back(root.asDiagonal() * matrix * root.asDiagonal());
        freedom.row(j).setConstant(reach.back().trace());
        freedom.col(j).setConstant(reach.back().trace());
    }
    for (Index j = 0; j < q; ++j)
        for (Index k = 0; k < q; ++k)
            freedom(j, k) =
                reach[static_cast<std::size_t>(j)].cwiseProduct(reach[static_cast<std::size_t>(k)]).sum();
    return {residuals.transpose() * residuals, freedom};
}

// Draws the correlations listed to zero as far as their spread is explained by their sampling variances.
void shrink(ArrayXd& correlation, const ArrayXd& variance) {
    if (correlation.size() == 0) return;
    const double signal = std::max(0.0, (correlation.square() - variance).mean());
    correlation *= signal / (signal + variance);
}

// The nearest thing to a correlation matrix whose eigenvalues are not tiny.
MatrixXd made_definite(const MatrixXd& correlation) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation);
    const MatrixXd raised = eigen.eigenvectors() *
                            eigen.eigenvalues().cwiseMax(least_eigenvalue).asDiagonal() *
                            eigen.eigenvectors().transpose();
    const VectorXd scale = raised.diagonal().cwiseSqrt().cwiseInverse();
    return scale.asDiagonal() * raised * scale.asDiagonal();
}

// Correlations between emulated scores are shrunk apart from the others, which are mostly none.
MatrixXd correlation_of(const Moments& moments, Index q) {
    const Index m = moments.products.rows();
    MatrixXd result = MatrixXd::Identity(m, m);
    for (const bool among_emulated : {true, false}) {
        std::vector<std::pair<Index, Index>> pairs;
        for (Index j = 0; j < m; ++j)
            for (Index i = j + 1; i < m; ++i)
                if ((i < q) == among_emulated) pairs.emplace_back(i, j);
        ArrayXd value(static_cast<Index>(pairs.size())), variance(value.size());
        for (std::size_t p = 0; p < pairs.size(); ++p) {
            const auto [i, j] = pairs[p];
            const double freedom = std::max(moments.freedom(i, j), 1.0);
            const double r = std::clamp(moments.products(i, j) / freedom, -0.95, 0.95);
            value(static_cast<Index>(p)) = r;
            // Second term: what the first, at an r found by chance near 1, makes too little of.
            variance(static_cast<Index>(p)) = (1 - r * r) * (1 - r * r) / freedom + 1 / (freedom * freedom);
        }
        shrink(value, variance);
        for (std::size_t p = 0; p < pairs.size(); ++p)
            result(pairs[p].first, pairs[p].second) = result(pairs[p].second, pairs[p].first) =
                value(static_cast<Index>(p));
    }
    return made_definite(result);
}

// What the standard deviations [m] of a covariance of the outputs must be multiplied by to be those of the
// moments as they are; factors are drawn to their mean as far as their spread is chance.
VectorXd output_scale(const MatrixXd& covariance, const MatrixXd& back, const Moments& moments) {
    const MatrixXd unbiased = moments.products.cwiseQuotient(moments.freedom.cwiseMax(1.0));
    const VectorXd variance = (back * unbiased * back.transpose()).diagonal();
    const ArrayXd log_ratio =
        variance.cwiseQuotient(covariance.diagonal()).array().max(least_variance_ratio).log();
    const double mean = log_ratio.mean(), chance = 2 / moments.freedom.mean();
    const double spread = (log_ratio - mean).square().mean();
    const double share = spread > chance ? 1 - chance / spread : 0.0;
    return (0.5 * (mean + share * (log_ratio - mean))).exp();
}

}  // namespace

double CurveNoise::scale(const Eigen::Ref<const VectorXd>& x) const {
    return std::exp(slope.dot((x.array() - 0.5).matrix()));
}

MatrixXd estimate_noise_covariance(const NoiseEvidence& evidence, const VectorXd& slope,
                                   const MatrixXd& from_scores) {
    const ReplicateGroups& groups = evidence.groups;
    const VectorXd level_sd = noise_levels(evidence, slope).cwiseSqrt();
    const MatrixXd sd = noise_factor(groups.inputs, slope).cwiseSqrt() * level_sd.transpose();
    Moments moments = residual_moments(evidence, sd);
    const MatrixXd deviations = groups.deviations(evidence.scores).cwiseQuotient(for_each_run(groups, sd));
    moments.products += deviations.transpose() * deviations;
    moments.freedom.array() += static_cast<double>(groups.rows() - groups.size());
    const MatrixXd back = from_scores * level_sd.asDiagonal();
    const MatrixXd covariance = back * correlation_of(moments, emulated(evidence)) * back.transpose();
    const VectorXd scale = output_scale(covariance, back, moments);
    return scale.asDiagonal() * covariance * scale.asDiagonal();
}

VectorXd estimate_noise_slope(const NoiseEvidence& evidence) {
    const ReplicateGroups& groups = evidence.groups;
    const Index m = evidence.scores.cols(), q = emulated(evidence), d = groups.inputs.cols();
    VectorXd squares = VectorXd::Zero(groups.size());
    VectorXd freedom = static_cast<double>(m - q) * groups.count;
    for (Index j = 0; j < q; ++j) {
        // alpha^2 / Q_gg has mean 1 if the variances are right; of it, the share V Q_gg speaks of the noise.
        const GaussianProcess& process = evidence.processes[static_cast<std::size_t>(j)];
        const VectorXd noise = noise_of_means(evidence, process);
        squares += noise.cwiseProduct(process.system().alpha.cwiseAbs2()) +
                   process.data().scatter.cwiseQuotient(process.system().noise);
        freedom += noise.cwiseProduct(process.system().q_diagonal()) + (groups.count.array() - 1).matrix();
    }
    const VectorXd level = noise_levels(evidence, VectorXd::Zero(d));
    for (Index j = q; j < m; ++j)
        squares += groups.means(evidence.scores.col(j).cwiseAbs2()).cwiseProduct(groups.count) / level(j);
    return log_variance_slope(groups.inputs, squares, freedom);
}

VectorXd log_variance_slope(const MatrixXd& inputs, const VectorXd& squares, const VectorXd& freedom) {
    const Index d = inputs.cols();
    const double total = freedom.sum();
    const MatrixXd centred = inputs.array() - 0.5;
    // -2 log likelihood with the level profiled out, up to a constant; convex in the slope b.
    const auto deviance = [&](const VectorXd& b) {
        return total * std::log(squares.dot((-centred * b).array().exp().matrix())) +
               freedom.dot(centred * b);
    };
    VectorXd slope = VectorXd::Zero(d);
    if (!(squares.sum() > 0)) return slope;
    const double flat = deviance(slope);
    double best = flat;
    for (int iteration = 0; iteration < 50; ++iteration) {
        VectorXd weight = squares.cwiseProduct((-centred * slope).array().exp().matrix());
        weight /= weight.sum();
        const VectorXd mean = centred.transpose() * weight;
        const VectorXd gradient = centred.transpose() * freedom - total * mean;
        MatrixXd hessian =
            total * (centred.transpose() * weight.asDiagonal() * centred - mean * mean.transpose());
        hessian.diagonal().array() += 1e-9 * total;
        const VectorXd step = hessian.ldlt().solve(gradient);
        double length = 1;
        while (length > 1e-6 && !(deviance(slope - length * step) < best)) length *= 0.5;
        if (length <= 1e-6) break;
        slope -= length * step;
        best = deviance(slope);
    }
    const bool preferred = flat - best > static_cast<double>(d) * std::log(total);
    if (!preferred) return VectorXd::Zero(d);
    return slope.cwiseMax(-steepest_slope).cwiseMin(steepest_slope);
}

}  // namespace loam::surrogate
