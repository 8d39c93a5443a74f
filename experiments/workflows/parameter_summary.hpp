// What a calibration says of each parameter, in SI.
#pragma once

#include <string>
#include <vector>

#include "experiments/campaign.hpp"
#include "experiments/fit.hpp"

namespace loam::experiments {

struct ParameterSummary {
    std::string name, symbol, unit, meaning;
    double estimate = 0, q05 = 0, q50 = 0, q95 = 0;  // SI
    double prior_q05 = 0, prior_q95 = 0;             // SI
    bool logarithmic = false, identified = false, fixed = false;
};

/// All parameters of the law, in its order. One is identified if its interval is clearly narrower than the
/// prior's and holds the estimate; those that are fixed have their value everywhere and count as identified.
std::vector<ParameterSummary> summarise(const Campaign& campaign, const Fit& fit);

/// The same from an estimate [d] and the 5, 50 and 95 % quantiles [d x 3] of the posterior, in the unit cube.
std::vector<ParameterSummary> summarise(const ParameterSpace& space, const Eigen::VectorXd& estimate,
                                        const Eigen::MatrixXd& quantiles);
/// Those quantiles [d x 3] of draws [n x d].
Eigen::MatrixXd quantiles_of(const Eigen::MatrixXd& draws);

/// A sentence for each test whose specimens could not be made as dense or loose as measured.
std::vector<std::string> density_warnings(Campaign& campaign, const std::vector<RunRecord>& runs);

}  // namespace loam::experiments
