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

constexpr Index first_look_inputs = 300;  // a first estimate of the noise needs no more
constexpr Index learning_inputs = 500;    // nor do hyper-parameters, which cost the cube of their number
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

// How processes are fitted to components, and to how many at most.
struct Fitting {
    GaussianProcessOptions process;
    Index max_components;
    int threads;
};

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

// All runs at inputs spread evenly over the order in which they came.
std::vector<Index> learning_rows(const ReplicateGroups& groups) {
    std::vector<Index> rows;
    const Index g = groups.size(), kept = std::min(g, learning_inputs);
    for (Index i = 0; i < groups.rows(); ++i) {
        const Index group = groups.group[static_cast<std::size_t>(i)];
        if (group * kept / g != (group + 1) * kept / g) rows.push_back(i);
    }
    return rows;
}

// One process for each of the `count` columns of the scores from `first` on; adds to `evaluations`.
std::vector<GaussianProcess> fit_components(const Data& data, const MatrixXd& scores, Index first,
                                            Index count, const Fitting& how, int& evaluations) {
    std::vector<std::optional<GaussianProcess>> fits(static_cast<std::size_t>(count));
    std::vector<std::exception_ptr> errors(fits.size());
    std::vector<int> spent(fits.size(), 0);
    const bool all = data.groups.size() <= learning_inputs;
    const std::vector<Index> rows = learning_rows(data.groups);
    const MatrixXd learning = data.inputs(rows, Eigen::all);
    const int threads = how.threads > 0 ? how.threads : omp_get_max_threads();
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
    for (Index i = 0; i < count; ++i) {
        const auto which = static_cast<std::size_t>(i);
        const VectorXd score = scores.col(first + i);
        try {
            GaussianProcessOptions own = how.process;
            own.seed = optimizers::hash(own.seed + static_cast<std::size_t>(first) + which);
            const GaussianProcess learnt = GaussianProcess::fit(learning, score(rows), own);
            spent[which] = learnt.summary().evaluations;
            fits[which] =
                all ? learnt : GaussianProcess::condition(data.inputs, score, learnt.hyperparameters(), own);
        } catch (...) {
            errors[which] = std::current_exception();
        }
    }
    std::vector<GaussianProcess> processes;
    for (std::size_t i = 0; i < fits.size(); ++i) {
        if (errors[i]) std::rethrow_exception(errors[i]);
        processes.push_back(std::move(*fits[i]));
        evaluations += spent[i];
    }
    return processes;
}

// At least one component is emulated, and never so many that the inputs could not tell signal from noise.
Index allowed(Index wanted, Index most, const ReplicateGroups& groups) {
    return std::clamp<Index>(wanted, 1, std::min<Index>(most, groups.size() - 2));
}

// Components of whitened curves that vary more than noise alone lets the first of them; but as many as there
// are inputs, for with fewer these could not be told apart, and a process knows noise when it sees it.
Index above_noise(const CurveBasis& basis, const Data& data) {
    const double ratio = static_cast<double>(basis.offset.size()) / static_cast<double>(data.groups.size());
    const Index above = (basis.score_variance.array() > std::pow(1 + std::sqrt(ratio), 2)).count();
    return std::max(above, std::min(data.inputs.cols(), basis.score_variance.size()));
}

// Whether the inputs explain a component better than noise does, by BIC: a process has a variance and its
// lengths more.
bool shows_signal(const GaussianProcess& process) {
    const GroupedData& data = process.data();
    const double more = static_cast<double>(1 + data.inputs.cols());
    return process.system().log_likelihood - constant_log_likelihood(data) >
           0.5 * more * std::log(static_cast<double>(data.mean.size()));
}

struct Signal {
    std::vector<GaussianProcess> processes;
    bool cut = false;  // there may be more than may be emulated
};

// Processes for the components of whitened curves that are not noise.
Signal fit_signal(const Data& data, const CurveBasis& basis, const MatrixXd& scores, const Fitting& how,
                  int& evaluations) {
    const Index sure = above_noise(basis, data),
                most = allowed(scores.cols(), how.max_components, data.groups);
    Signal signal{fit_components(data, scores, 0, std::min(sure, most), how, evaluations)};
    while (true) {
        const auto fitted = static_cast<Index>(signal.processes.size());
        if (fitted == most) {
            signal.cut = most < scores.cols();
            return signal;
        }
        // Two at a time, which is what two cores do in the time of one, whatever the number of threads.
        for (GaussianProcess& next :
             fit_components(data, scores, fitted, std::min<Index>(2, most - fitted), how, evaluations)) {
            if (!shows_signal(next)) return signal;
            signal.processes.push_back(std::move(next));
        }
    }
}

// What the careful fit has to know of the noise beforehand.
struct FirstLook {
    MatrixXd metric;  // [m x m] covariance at the centre of the cube, made a little stiffer
    VectorXd slope;   // [d] of its logarithm
};

// From processes fitted quickly to the standardised, then to the whitened curves.
FirstLook first_look(const Data& data, const CurveEmulatorOptions& options, int& evaluations) {
    const Fitting quick{{.kernel = options.kernel,
                         .starts = 1,
                         .max_evaluations = 60,
                         .relative_floor = relative_floor,
                         .seed = options.seed},
                        options.max_components,
                        options.threads};
    const VectorXd level = VectorXd::Zero(data.inputs.cols());
    const MatrixXd curves = data.groups.means(data.outputs);
    CurveBasis basis = standardised_basis(curves);
    MatrixXd scores = basis.scores(data.outputs);
    const Index varying = (basis.score_variance.array() > 1e-8 * basis.score_variance.sum()).count();
    const Index count = allowed(varying, options.max_components, data.groups);
    const auto processes = fit_components(data, scores, 0, count, quick, evaluations);
    FirstLook look{estimate_noise_covariance({data.groups, scores, processes}, level, basis.from_scores),
                   level};
    // Directions in which the noise seems next to nothing are the worst known; they must not lead.
    look.metric.diagonal() *= 1 + metric_ridge;
    if (!options.noise_slope) return look;

    basis = whitened_basis(curves, look.metric);
    scores = basis.scores(data.outputs);
    const Signal signal = fit_signal(data, basis, scores, quick, evaluations);
    look.slope = estimate_noise_slope({data.groups, scores, signal.processes});
    return look;
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
    const FirstLook look = first_look(bounded(data, first_look_inputs), options, summary.evaluations);

    emulator.groups_ = data.groups;
    emulator.actual_ = data.groups.means(outputs);
    emulator.basis_ = whitened_basis(emulator.actual_, look.metric);
    const MatrixXd scores = emulator.basis_.scores(outputs);
    const Fitting careful{{.kernel = options.kernel,
                           .noise_slope = look.slope,
                           .starts = options.starts,
                           .relative_floor = relative_floor,
                           .seed = options.seed},
                          options.max_components,
                          options.threads};
    Signal signal = fit_signal(data, emulator.basis_, scores, careful, summary.evaluations);
    emulator.processes_ = std::move(signal.processes);
    emulator.noise_ = {estimate_noise_covariance({data.groups, scores, emulator.processes_}, look.slope,
                                                 emulator.basis_.from_scores),
                       look.slope};

    const VectorXd& variance = emulator.basis_.score_variance;
    summary.stopped_by = signal.cut ? "most components allowed" : "the rest is noise";
    summary.runs = outputs.rows();
    summary.inputs = data.groups.size();
    summary.components = emulator.components();
    summary.kept_variance = variance.head(summary.components).sum() / variance.sum();
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

VectorXd CurveEmulator::predict_component_means(const Eigen::Ref<const VectorXd>& x) const {
    VectorXd scores(components());
    for (Index j = 0; j < components(); ++j)
        scores(j) = processes_[static_cast<std::size_t>(j)].predict_mean(x);
    return scores;
}

void CurveEmulator::predict_components(const MatrixXd& points, MatrixXd& mean, MatrixXd& variance) const {
    mean.resize(points.rows(), components());
    variance.resize(points.rows(), components());
    for (Index j = 0; j < components(); ++j)
        processes_[static_cast<std::size_t>(j)].predict_many(points, mean.col(j), variance.col(j));
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

VectorXd CurveEmulator::typical_variance() const {
    VectorXd out(components());
    for (Index j = 0; j < components(); ++j)
        out(j) = processes_[static_cast<std::size_t>(j)].leave_one_out().variance.mean();
    return out;
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
