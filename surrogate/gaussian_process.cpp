#include "surrogate/gaussian_process.hpp"

#include <cmath>
#include <stdexcept>

#include "surrogate/linear_algebra.hpp"
#include "surrogate/replicates.hpp"

namespace loam::surrogate {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Index prediction_block = 256;  // points predicted at once: their covariances stay in the cache

[[noreturn]] void mismatch(const char* name, Index size, Index expected) {
    throw std::invalid_argument("Gaussian process: " + std::string(name) + " has " + std::to_string(size) +
                                " entries, but there should be " + std::to_string(expected));
}

void check(const MatrixXd& inputs, const VectorXd& outputs, const VectorXd& known_variance) {
    if (inputs.cols() < 1) throw std::invalid_argument("Gaussian process: inputs need at least one column");
    if (outputs.size() != inputs.rows()) mismatch("outputs", outputs.size(), inputs.rows());
    if (known_variance.size() != 0 && known_variance.size() != inputs.rows())
        mismatch("known_variance", known_variance.size(), inputs.rows());
    require_finite(inputs, "Gaussian process: inputs");
    require_finite(outputs, "Gaussian process: outputs");
    require_finite(known_variance, "Gaussian process: known_variance");
    if ((known_variance.array() < 0).any())
        throw std::invalid_argument("Gaussian process: known_variance must not be negative");
}

// Rows of equal input and equal known variance become one.
GroupedData gather(const MatrixXd& inputs, const VectorXd& outputs, const VectorXd& known_variance) {
    MatrixXd keys(inputs.rows(), inputs.cols() + 1);
    keys.leftCols(inputs.cols()) = inputs;
    keys.rightCols<1>() = known_variance.size() ? known_variance : VectorXd::Zero(inputs.rows());
    const ReplicateGroups groups = find_replicates(keys);
    GroupedData data{
        .inputs = groups.inputs.leftCols(inputs.cols()),
        .mean = groups.means(outputs),
        .count = groups.count,
        .scatter = groups.means(groups.deviations(outputs).cwiseAbs2()).cwiseProduct(groups.count),
        .known_variance = groups.inputs.rightCols<1>()};
    return data;
}

// Standard deviation of all runs about the centre, which is zero.
double spread(const GroupedData& data) {
    const double sum = data.count.dot(data.mean.cwiseAbs2()) + data.scatter.sum();
    const double sd = std::sqrt(sum / data.count.sum());
    return sd > 0 ? sd : 1;  // a constant output is fitted as it stands
}

}  // namespace

GaussianProcess::GaussianProcess(const MatrixXd& inputs, const VectorXd& outputs,
                                 const GaussianProcessOptions& options, const VectorXd& known_variance) {
    options.validate();
    check(inputs, outputs, known_variance);
    kernel_ = &find_kernel(options.kernel);
    data_ = gather(inputs, outputs, known_variance);
    if (data_.mean.size() < 3)
        throw std::invalid_argument("Gaussian process: " + std::to_string(data_.mean.size()) +
                                    " distinct inputs, but at least 3 are needed");
    centre_ = data_.count.dot(data_.mean) / data_.count.sum();
    data_.mean.array() -= centre_;
    noise_slope_ = options.noise_slope.size() ? options.noise_slope : VectorXd::Zero(inputs.cols()).eval();
    if (noise_slope_.size() != inputs.cols()) mismatch("noise_slope", noise_slope_.size(), inputs.cols());
    data_.noise_factor = ((data_.inputs.array() - 0.5).matrix() * noise_slope_).array().exp();
    const double scale = spread(data_);
    floor_ = options.relative_floor * scale * scale;
}

GaussianProcess GaussianProcess::fit(const MatrixXd& inputs, const VectorXd& outputs,
                                     const GaussianProcessOptions& options, const VectorXd& known_variance) {
    GaussianProcess process(inputs, outputs, options, known_variance);
    const double scale = spread(process.data_), square = scale * scale;
    GroupedData scaled = process.data_;
    scaled.mean /= scale;
    scaled.scatter /= square;
    scaled.known_variance /= square;
    Hyperparameters found = search_hyperparameters(*process.kernel_, scaled, options, process.summary_);
    found.variance *= square;
    found.nugget *= square;
    process.set(found);
    return process;
}

GaussianProcess GaussianProcess::condition(const MatrixXd& inputs, const VectorXd& outputs,
                                           const Hyperparameters& hyperparameters,
                                           const GaussianProcessOptions& options,
                                           const VectorXd& known_variance) {
    GaussianProcess process(inputs, outputs, options, known_variance);
    if (hyperparameters.length_scales.size() != inputs.cols())
        mismatch("length_scales", hyperparameters.length_scales.size(), inputs.cols());
    if (!(hyperparameters.variance > 0 && hyperparameters.nugget >= 0 &&
          (hyperparameters.length_scales.array() > 0).all()))
        throw std::invalid_argument(
            "Gaussian process: variance and length scales must be positive, nugget >= 0");
    process.summary_.stopped_by = "hyper-parameters given";
    process.set(hyperparameters);
    return process;
}

void GaussianProcess::set(const Hyperparameters& hyperparameters) {
    hyperparameters_ = hyperparameters;
    if (!RestrictedLikelihood(*kernel_, data_, floor_).solve(hyperparameters_, system_))
        throw std::runtime_error(
            "Gaussian process: the covariance of the data is not positive definite at these "
            "hyper-parameters");
    covariance_.emplace(*kernel_, data_.inputs, hyperparameters_.variance, hyperparameters_.length_scales);
    summary_.log_likelihood = system_.log_likelihood;
}

GaussianProcessPrediction GaussianProcess::predict(const Eigen::Ref<const VectorXd>& x,
                                                   bool gradients) const {
    MatrixXd jacobian;
    const VectorXd k = covariance_->vector(x, gradients ? &jacobian : nullptr);
    const VectorXd whitened = lower_product(system_.inverse_factor, k);
    // What the data leave open of the constant mean adds to the variance.
    const double open = 1 - system_.ones.dot(k);
    GaussianProcessPrediction prediction;
    prediction.mean = centre_ + system_.mean + k.dot(system_.alpha);
    prediction.variance = std::max(
        0.0, covariance_->variance() - whitened.squaredNorm() + open * open / system_.mean_precision);
    if (gradients) {
        prediction.mean_gradient = jacobian.transpose() * system_.alpha;
        const VectorXd solved = transposed_lower_product(system_.inverse_factor, whitened);
        prediction.variance_gradient =
            -2 * (jacobian.transpose() * (solved + (open / system_.mean_precision) * system_.ones));
    }
    return prediction;
}

void GaussianProcess::predict_many(const MatrixXd& points, Eigen::Ref<VectorXd> mean,
                                   Eigen::Ref<VectorXd> variance) const {
    MatrixXd k;
    for (Index first = 0; first < points.rows(); first += prediction_block) {
        const Index count = std::min(prediction_block, points.rows() - first);
        k.resize(covariance_->size(), count);
        for (Index p = 0; p < count; ++p) k.col(p) = covariance_->vector(points.row(first + p).transpose());
        mean.segment(first, count) = (k.transpose() * system_.alpha).array() + (centre_ + system_.mean);
        const VectorXd explained =
            lower_products(system_.inverse_factor, k).colwise().squaredNorm().transpose();
        const VectorXd open = (1 - (k.transpose() * system_.ones).array()).matrix();
        variance.segment(first, count) =
            (covariance_->variance() - explained.array() + open.array().square() / system_.mean_precision)
                .max(0.0);
    }
}

double GaussianProcess::predict_mean(const Eigen::Ref<const VectorXd>& x, VectorXd* gradient) const {
    MatrixXd jacobian;
    const VectorXd k = covariance_->vector(x, gradient ? &jacobian : nullptr);
    if (gradient) *gradient = jacobian.transpose() * system_.alpha;
    return centre_ + system_.mean + k.dot(system_.alpha);
}

double GaussianProcess::noise_variance(const Eigen::Ref<const VectorXd>& x) const {
    return floor_ + hyperparameters_.nugget * std::exp(noise_slope_.dot((x.array() - 0.5).matrix()));
}

GaussianProcessLeaveOneOut GaussianProcess::leave_one_out() const {
    const VectorXd q = system_.q_diagonal();
    const VectorXd residual = system_.alpha.cwiseQuotient(q);
    return {.mean = (data_.mean - residual).array() + centre_,
            .variance = (q.cwiseInverse() - system_.noise.cwiseQuotient(data_.count)).cwiseMax(0.0),
            .z = system_.alpha.cwiseQuotient(q.cwiseSqrt())};
}

}  // namespace loam::surrogate
