#include "surrogate/gp_search.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "optimizers/random.hpp"
#include "optimizers/registry.hpp"
#include "surrogate/designs.hpp"

namespace loam::surrogate {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// Log density of the weak prior up to a constant; its gradient is added.
double log_prior(const VectorXd& log_parameters, Index d, VectorXd& gradient) {
    const double centre = 0.5 * std::log(static_cast<double>(d));
    const VectorXd lengths = log_parameters.segment(1, d).array() - centre;
    gradient.segment(1, d) -= lengths;
    return -0.5 * lengths.squaredNorm();
}

optimizers::Bounds search_box(Index d, double floor) {
    optimizers::Bounds box{VectorXd::Constant(2 + d, std::log(0.02)),
                           VectorXd::Constant(2 + d, std::log(1e3))};
    box.lower(0) = std::log(1e-6);
    box.lower(1 + d) = std::log(0.1 * floor);
    box.upper(1 + d) = std::log(10.0);
    return box;
}

// Nugget variance that the replicates show, or a hundredth of the output's where there are none.
double first_nugget(const GroupedData& data) {
    const double freedom = (data.count.array() - 1).sum();
    return freedom > 0 ? std::clamp(data.scatter.sum() / freedom, 1e-7, 1.0) : 1e-2;
}

// A start of middling lengths, then one of long lengths and little noise, then scrambled Sobol points of a
// box.
std::vector<VectorXd> search_starts(const GroupedData& data, const GaussianProcessOptions& options) {
    const Index d = data.inputs.cols();
    const double diagonal = std::sqrt(static_cast<double>(d)), nugget = first_nugget(data);
    std::vector<VectorXd> starts;
    for (int s = 0; s < options.starts; ++s) {
        VectorXd start = VectorXd::Zero(2 + d);
        start.segment(1, d).setConstant(std::log(s == 0 ? 0.5 * diagonal : 2 * diagonal));
        start(1 + d) = std::log(s == 0 ? nugget : 1e-2 * nugget);
        if (s >= 2) {
            const SobolOptions which{.seed = options.seed, .skip = static_cast<std::uint32_t>(s - 2)};
            const VectorXd u = sobol_sequence(1, 2 + d, which).row(0);
            start(0) = std::log(0.3) + u(0) * std::log(30.0);
            start.segment(1, d) =
                (std::log(0.15 * diagonal) + u.segment(1, d).array() * std::log(40.0)).matrix();
            start(1 + d) = std::log(1e-5) + u(1 + d) * std::log(3e4);
        }
        starts.push_back(std::move(start));
    }
    return starts;
}

GroupedData random_subset(const GroupedData& data, Index size, std::uint64_t seed) {
    std::vector<Index> order(static_cast<std::size_t>(data.mean.size()));
    std::iota(order.begin(), order.end(), Index{0});
    optimizers::Random random(seed, 1);
    for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
        const auto left = static_cast<std::int64_t>(order.size() - i);
        std::swap(order[i], order[i + static_cast<std::size_t>(random.index(left))]);
    }
    order.resize(static_cast<std::size_t>(size));
    return {data.inputs(order, Eigen::all), data.mean(order),        data.count(order), data.scatter(order),
            data.known_variance(order),     data.noise_factor(order)};
}

struct Search {
    const KernelInfo& kernel;
    const GaussianProcessOptions& options;
    GaussianProcessSummary& summary;

    optimizers::Minimum run(const GroupedData& data, const VectorXd& start) const {
        RestrictedLikelihood likelihood(kernel, data, options.relative_floor);
        const Index d = data.inputs.cols();
        const auto objective = [&](const VectorXd& x, VectorXd* gradient) {
            VectorXd slope = VectorXd::Zero(x.size());
            double value = likelihood.value(x, &slope);
            if (!std::isfinite(value)) return std::numeric_limits<double>::quiet_NaN();
            value += log_prior(x, d, slope);
            if (gradient) *gradient = -slope;
            return -value;
        };
        const optimizers::Options budget{
            .max_evaluations = options.max_evaluations, .relative_tolerance = 1e-6, .seed = options.seed};
        const auto box = search_box(d, options.relative_floor);
        optimizers::Minimum minimum = optimizers::minimise("lbfgs", objective, box, box.clamp(start), budget);
        ++summary.searches;
        summary.evaluations += minimum.summary.evaluations;
        summary.stopped_by = minimum.summary.stopped_by;
        return minimum;
    }
};

}  // namespace

void GaussianProcessOptions::validate() const {
    const auto require = [](bool holds, const char* field, double value, const char* constraint) {
        if (holds) return;
        std::ostringstream message;
        message << "Gaussian process: " << field << " = " << value << ", but it must be " << constraint;
        throw std::invalid_argument(message.str());
    };
    find_kernel(kernel);
    if (!noise_slope.allFinite()) throw std::invalid_argument("Gaussian process: noise_slope must be finite");
    require(starts >= 1, "starts", starts, "at least 1");
    require(max_evaluations >= 1, "max_evaluations", max_evaluations, "at least 1");
    require(subset >= 50, "subset", subset, "at least 50");
    require(relative_floor >= 1e-12 && relative_floor <= 1, "relative_floor", relative_floor,
            "in [1e-12, 1]");
}

Hyperparameters search_hyperparameters(const KernelInfo& kernel, const GroupedData& data,
                                       const GaussianProcessOptions& options,
                                       GaussianProcessSummary& summary) {
    const auto began = std::chrono::steady_clock::now();
    const Search search{kernel, options, summary};
    const bool large = data.mean.size() > options.subset;
    const GroupedData subset = large ? random_subset(data, options.subset, options.seed) : GroupedData{};
    std::optional<optimizers::Minimum> best;
    for (const VectorXd& start : search_starts(data, options)) {
        optimizers::Minimum minimum = search.run(large ? subset : data, start);
        if (!best || minimum.value < best->value) best = std::move(minimum);
    }
    if (large) best = search.run(data, best->x);
    summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return Hyperparameters::from_log(best->x);
}

}  // namespace loam::surrogate
