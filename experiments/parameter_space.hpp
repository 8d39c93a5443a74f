// The parameters of the contact law as a campaign sees them: which are fitted, on which prior, which are
// fixed.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/contact/registry.hpp"
#include "engine/simulation.hpp"
#include "experiments/settings/settings.hpp"
#include "surrogate/priors.hpp"

namespace loam::experiments {

/// Whether a coordinate of the unit cube lies at one of its bounds, for all that a fit can tell.
inline bool is_at_a_bound(double unit) {
    constexpr double near = 0.01;
    return unit < near || unit > 1 - near;
}

struct ParameterSpace {
    std::vector<engine::ParameterInfo> parameters;  // of the law, then of the effects
    std::vector<std::size_t> fitted;                // [d] places in parameters
    std::vector<surrogate::Prior> priors;           // [d]
    Eigen::VectorXd values;  // [parameters]: the fixed ones; prior medians elsewhere (SI)

    Eigen::Index dimension() const { return static_cast<Eigen::Index>(fitted.size()); }
    const engine::ParameterInfo& info(Eigen::Index k) const {
        return parameters[fitted[static_cast<std::size_t>(k)]];
    }
    const surrogate::Prior& prior(Eigen::Index k) const { return priors[static_cast<std::size_t>(k)]; }
    bool is_logarithmic(Eigen::Index k) const;

    /// All parameters (SI) at x [d] in the unit cube.
    Eigen::VectorXd physical(const Eigen::VectorXd& x) const;
    /// Coordinates [d] of all parameters (SI).
    Eigen::VectorXd unit(const Eigen::VectorXd& physical) const;
    /// Maps probabilities [n x d] through the priors' quantiles to coordinates [n x d].
    Eigen::MatrixXd from_probabilities(const Eigen::MatrixXd& u) const;
};

/// The space that the settings describe. The law must exist, every parameter be in `set` or have a prior.
ParameterSpace parameter_space(const Settings& settings);

/// The settings' law and effects with these parameters (SI, in the order of ParameterSpace::parameters).
engine::ContactLaw contact_law(const Settings& settings, const Eigen::VectorXd& physical);

}  // namespace loam::experiments
