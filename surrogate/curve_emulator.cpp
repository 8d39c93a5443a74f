#include "surrogate/curve_emulator.hpp"

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "optimizers/random.hpp"

namespace loam::surrogate {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Index rough_inputs = 300;  // a first estimate of the noise needs no more
constexpr double metric_ridge =
    0.01;  // part of the outputs' own noise variance added to the whitening metric
constexpr double relative_floor = 1e-10;  // numerical noise of a component over its variance
constexpr double central_90 = 1.6448536269514722;

struct Data {
    MatrixXd inputs, outputs;
    ReplicateGroups groups;
};

void check(const MatrixXd& inputs, const MatrixXd& outputs) {
    if (inputs.rows() != outputs.rows())
        throw std::invalid_argument("curve emulator: " + std::to_string(inputs.rows()) +
                                    " rows of inputs, but " + std::to_string(outputs.rows()) + " of outputs");
    if (inputs.cols() < 1 || outputs.cols() < 1)
        throw std::invalid_argument("curve emulator: inputs and outputs need at least one column");
    require_finite(inputs, "curve emulator: inputs");
    require_finite(outputs, "curve emulator: outputs");
}

// All runs at a bounded number of inputs, the most repeated ones first: they say most about the noise.
Data bounded(const Data& data, Index most) {
    if (data.groups.size() <= most) return data;
    std::vector<Index> order(static_cast<std::size_t>(data.groups.size())), rows;
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](Index a, Index b) { return data.groups.count(a) > data.groups.count(b); });
    std::vector<bool> kept(order.size(), false);
    for (Index i = 0; i < most; ++i)
        kept[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])] = true;
    for (Index i = 0; i < data.groups.rows(); ++i)
        if (kept[static_cast<std::size_t>(data.groups.group[static_cast<std::size_t>(i)])]) rows.push_back(i);
    const MatrixXd inputs = data.inputs(rows, Eigen::all);
    return {inputs, data.outputs(rows, Eigen::all), find_replicates(inputs)};
}

struct ComponentFits {
    std::vector<GaussianProcess> processes;
    int evaluations = 0;
};

// One process for each of the first `count` columns of the scores.
ComponentFits fit_components(const Data& data, const MatrixXd& scores, Index count,
                             const GaussianProcessOptions& options, int threads) {
    std::vector<std::optional<GaussianProcess>> fits(static_cast<std::size_t>(count));
    std::vector<std::exception_ptr> errors(fits.size());
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads > 0 ? threads : omp_get_max_threads())
    for (Index j = 0; j < count; ++j) {
        const auto which = static_cast<std::size_t>(j);
        try {
            GaussianProcessOptions own = options;
            own.seed = optimizers::hash(options.seed + which);
            fits[which] = GaussianProcess::fit(data.inputs, scores.col(j), own);
        } catch (...) {
            errors[which] = std::current_exception();
        }
    }
    ComponentFits result;
    for (std::size_t j = 0; j < fits.size(); ++j) {
        if (errors[j]) std::rethrow_exception(errors[j]);
        result.processes.push_back(std::move(*fits[j]));
        result.evaluations += result.processes.back().summary().evaluations;
    }
    return result;
}

// Covariance of the noise at the centre of the cube, from processes fitted quickly to the standardised
// curves.
MatrixXd rough_noise(const Data& data, const CurveEmulatorOptions& options, int& evaluations) {
    const CurveBasis basis = standardised_basis(data.groups.means(data.outputs));
    const double total = basis.score_variance.sum();
    const Index count = std::clamp<Index>((basis.score_variance.array() > 1e-8 * total).count(), 1,
                                          std::min<Index>(options.max_components, data.groups.size() - 2));
    const MatrixXd scores = basis.scores(data.outputs);
    const GaussianProcessOptions quick{.kernel = options.kernel,
                                       .starts = 1,
                                       .max_evaluations = 60,
                                       .relative_floor = relative_floor,
                                       .seed = options.seed};
    const ComponentFits fits = fit_components(data, scores, count, quick, options.threads);
    evaluations += fits.evaluations;
    const MatrixXd covariance =
        estimate_noise_covariance({data.groups, scores, fits.processes}, VectorXd::Zero(data.inputs.cols()));
    MatrixXd noise = basis.from_scores * covariance * basis.from_scores.transpose();
    // Directions in which the noise seems next to nothing are the worst known; they must not lead the
    // components.
    noise.diagonal() *= 1 + metric_ridge;
    return noise;
}

}  // namespace

void CurveEmulatorOptions::validate() const {
    GaussianProcessOptions{.kernel = kernel, .starts = starts}.validate();
    const auto require = [](bool holds, const char* field, int value, const char* constraint) {
        if (!holds)
            throw std::invalid_argument("curve emulator: " + std::string(field) + " = " +
                                        std::to_string(value) + ", but it must be " + constraint);
    };
    require(max_components >= 1, "max_components", max_components, "at least 1");
    require(threads >= 0, "threads", threads, "at least 0");
}

CurveEmulator CurveEmulator::fit(const MatrixXd& inputs, const MatrixXd& outputs,
                                 const CurveEmulatorOptions& options) {
    const auto began = std::chrono::steady_clock::now();
    options.validate();
    check(inputs, outputs);
    const Data data{inputs, outputs, find_replicates(inputs)};
    const Index least = std::max<Index>(5, inputs.cols() + 2);
    if (data.groups.size() < least)
        throw std::invalid_argument("curve emulator: " + std::to_string(data.groups.size()) +
                                    " distinct inputs, but at least " + std::to_string(least) +
                                    " are needed");
    CurveEmulator emulator;
    CurveEmulatorSummary& summary = emulator.summary_;
    emulator.groups_ = data.groups;
    emulator.actual_ = data.groups.means(outputs);
    emulator.basis_ = whitened_basis(emulator.actual_,
                                     rough_noise(bounded(data, rough_inputs), options, summary.evaluations));

    const double ratio = static_cast<double>(outputs.cols()) / static_cast<double>(data.groups.size());
    const double edge = std::pow(1 + std::sqrt(ratio), 2);
    const VectorXd& variance = emulator.basis_.score_variance;
    const Index above = (variance.array() > edge).count();
    const Index count =
        std::clamp<Index>(above, 1, std::min<Index>(options.max_components, data.groups.size() - 2));
    summary.stopped_by = above > count ? "most components allowed" : "the rest is noise";

    const MatrixXd scores = emulator.basis_.scores(outputs);
    GaussianProcessOptions careful{.kernel = options.kernel,
                                   .starts = options.starts,
                                   .relative_floor = relative_floor,
                                   .seed = options.seed};
    ComponentFits fits = fit_components(data, scores, count, careful, options.threads);
    summary.evaluations += fits.evaluations;
    VectorXd slope = VectorXd::Zero(inputs.cols());
    if (options.noise_slope) slope = estimate_noise_slope({data.groups, scores, fits.processes});
    if (!slope.isZero(0)) {
        careful.noise_slope = slope;
        fits = fit_components(data, scores, count, careful, options.threads);
        summary.evaluations += fits.evaluations;
    }
    const MatrixXd covariance = estimate_noise_covariance({data.groups, scores, fits.processes}, slope);
    const MatrixXd& back = emulator.basis_.from_scores;
    emulator.noise_ = {back * covariance * back.transpose(), slope};
    emulator.processes_ = std::move(fits.processes);

    summary.runs = outputs.rows();
    summary.inputs = data.groups.size();
    summary.components = count;
    summary.kept_variance = variance.head(count).sum() / variance.sum();
    summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return emulator;
}

ComponentPrediction CurveEmulator::predict_components(const Eigen::Ref<const VectorXd>& x,
                                                      bool gradients) const {
    const Index q = components();
    ComponentPrediction prediction{VectorXd(q), VectorXd(q), {}, {}};
    if (gradients) {
        prediction.mean_jacobian.resize(q, x.size());
        prediction.variance_jacobian.resize(q, x.size());
    }
    for (Index j = 0; j < q; ++j) {
        const GaussianProcessPrediction one = processes_[static_cast<std::size_t>(j)].predict(x, gradients);
        prediction.mean(j) = one.mean;
        prediction.variance(j) = one.variance;
        if (!gradients) continue;
        prediction.mean_jacobian.row(j) = one.mean_gradient;
        prediction.variance_jacobian.row(j) = one.variance_gradient;
    }
    return prediction;
}

CurvePrediction CurveEmulator::predict(const Eigen::Ref<const VectorXd>& x) const {
    const ComponentPrediction scores = predict_components(x);
    return {.mean = offset() + loadings() * scores.mean,
            .emulator_covariance = loadings() * scores.variance.asDiagonal() * loadings().transpose(),
            .noise_covariance = noise_.covariance(x)};
}

VectorXd CurveEmulator::predict_mean(const Eigen::Ref<const VectorXd>& x, MatrixXd* jacobian) const {
    VectorXd scores(components()), gradient;
    MatrixXd gradients(components(), x.size());
    for (Index j = 0; j < components(); ++j) {
        scores(j) = processes_[static_cast<std::size_t>(j)].predict_mean(x, jacobian ? &gradient : nullptr);
        if (jacobian) gradients.row(j) = gradient;
    }
    if (jacobian) *jacobian = loadings() * gradients;
    return offset() + loadings() * scores;
}

CurveLeaveOneOut CurveEmulator::leave_one_out() const {
    const Index g = groups_.size(), m = actual_.cols(), q = components();
    MatrixXd scores(g, q), variances(g, q);
    for (Index j = 0; j < q; ++j) {
        const GaussianProcessLeaveOneOut one = processes_[static_cast<std::size_t>(j)].leave_one_out();
        scores.col(j) = one.mean;
        variances.col(j) = one.variance;
    }
    CurveLeaveOneOut result{.inputs = groups_.inputs,
                            .actual = actual_,
                            .predicted = (scores * loadings().transpose()).rowwise() + offset().transpose(),
                            .z = MatrixXd(g, m),
                            .rmse = VectorXd(),
                            .coverage = VectorXd()};
    const MatrixXd errors = result.actual - result.predicted;
    for (Index i = 0; i < g; ++i) {
        const VectorXd noise =
            noise_.covariance(groups_.inputs.row(i).transpose()).diagonal() / groups_.count(i);
        const VectorXd variance = loadings().cwiseAbs2() * variances.row(i).transpose() + noise;
        result.z.row(i) = errors.row(i).transpose().cwiseQuotient(variance.cwiseSqrt());
    }
    result.rmse = (errors.cwiseAbs2().colwise().mean()).cwiseSqrt();
    result.coverage =
        (result.z.cwiseAbs().array() < central_90).cast<double>().colwise().mean().matrix().transpose();
    return result;
}

}  // namespace loam::surrogate
