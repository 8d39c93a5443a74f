#include "experiments/bulk/inverse_kriging.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double largest_strain = 0.35;  // runs beyond it are left out (De Pue et al. 2019, section 2.3)
constexpr Index fewest_runs = 30;
constexpr double central_90 = 1.6448536269514722;
constexpr double least_share = 1e-3;  // of the variance, that sill and nugget are at least

surrogate::GaussianProcess kriging(const MatrixXd& strain, const VectorXd& values,
                                   const std::vector<StageSemivariogram>& stages) {
    const auto best =
        std::ranges::min_element(stages, {}, [](const StageSemivariogram& s) { return s.model.nugget; });
    const double variance = (values.array() - values.mean()).square().mean();
    surrogate::Hyperparameters h;
    h.variance = std::max(best->model.sill, least_share * variance);
    h.nugget = std::max(best->model.nugget, least_share * variance);
    h.length_scales.resize(static_cast<Index>(stages.size()));
    // The kernel is exp(-h^2 / 2), the semivariogram's exp(-h^2).
    const double together = std::sqrt(0.5 * static_cast<double>(stages.size()));
    for (std::size_t k = 0; k < stages.size(); ++k)
        h.length_scales[static_cast<Index>(k)] = stages[k].model.range * together;
    surrogate::GaussianProcessOptions options;
    options.kernel = "squared_exponential";
    return surrogate::GaussianProcess::condition(strain, values, h, options);
}

}  // namespace

InverseKriging::InverseKriging(const SharedEnsemble& ensemble, const std::vector<RunRecord>& runs)
    : ensemble_(ensemble), runs_(runs) {}

void InverseKriging::predictors(const BulkSample& sample, MatrixXd& strain, MatrixXd& parameters) const {
    std::vector<VectorXd> curves, inputs;
    for (const RunRecord& run : runs_) {
        if (!run.ok || run.outputs[run.outputs.size() - 1] < static_cast<double>(sample.needed)) continue;
        VectorXd t(sample.stages());
        for (Index k = 0; k < t.size(); ++k) t[k] = sample.transform.forward(run.outputs[k]);
        VectorXd curve = sample.interpolation * t;
        for (double& y : curve) y = sample.transform.inverse(y);
        if (curve.maxCoeff() > largest_strain) continue;
        curves.push_back(std::move(curve));
        inputs.push_back(ensemble_.space().unit(run.spec.parameters));
    }
    const auto n = static_cast<Index>(curves.size());
    if (n < fewest_runs)
        throw std::runtime_error(
            fmt::format("only {} runs of the ensemble reached the sample's last stage, and kriging needs {}: "
                        "--runs N makes more",
                        n, fewest_runs));
    strain.resize(n, sample.curve.stress.size());
    parameters.resize(n, ensemble_.space().dimension());
    for (Index r = 0; r < n; ++r) {
        strain.row(r) = curves[static_cast<std::size_t>(r)].transpose();
        parameters.row(r) = inputs[static_cast<std::size_t>(r)].transpose();
    }
}

std::vector<std::vector<StageSemivariogram>> InverseKriging::semivariograms(const BulkSample& sample) const {
    MatrixXd strain, parameters;
    predictors(sample, strain, parameters);
    std::vector<std::vector<StageSemivariogram>> out(static_cast<std::size_t>(parameters.cols()));
    for (Index p = 0; p < parameters.cols(); ++p)
        for (Index k = 0; k < strain.cols(); ++k) {
            StageSemivariogram s{sample.curve.stress[k],
                                 surrogate::experimental_semivariogram(strain.col(k), parameters.col(p)),
                                 {}};
            s.model = surrogate::fit_gaussian(s.experimental);
            out[static_cast<std::size_t>(p)].push_back(std::move(s));
        }
    return out;
}

std::shared_ptr<const InverseKriging::Model> InverseKriging::model_of(const BulkSample& sample) {
    const std::vector<double> key(sample.curve.stress.begin(), sample.curve.stress.end());
    // Whoever comes first makes it; the others wait, and most data sets have few different sets of stages.
    const std::scoped_lock lock(mutex_);
    auto& model = models_[key];
    if (model) return model;
    MatrixXd strain, parameters;
    predictors(sample, strain, parameters);
    const auto stages = semivariograms(sample);
    auto made = std::make_shared<Model>();
    for (Index p = 0; p < parameters.cols(); ++p)
        made->processes.push_back(kriging(strain, parameters.col(p), stages[static_cast<std::size_t>(p)]));
    model = std::move(made);
    return model;
}

FittedSample InverseKriging::fit(const BulkSample& sample) {
    const std::shared_ptr<const Model> model = model_of(sample);
    const auto d = static_cast<Index>(model->processes.size());
    FittedSample out;
    out.row = sample.row;
    out.estimate.resize(d);
    out.quantiles.resize(d, 3);
    for (Index p = 0; p < d; ++p) {
        const surrogate::GaussianProcess& process = model->processes[static_cast<std::size_t>(p)];
        const auto at = process.predict(sample.curve.strain);
        const double sd = std::sqrt(at.variance + process.noise_variance(sample.curve.strain));
        out.estimate[p] = std::clamp(at.mean, 0.0, 1.0);
        out.quantiles.row(p) << at.mean - central_90 * sd, at.mean, at.mean + central_90 * sd;
    }
    out.quantiles = out.quantiles.cwiseMax(0.0).cwiseMin(1.0);
    return out;
}

}  // namespace loam::experiments
