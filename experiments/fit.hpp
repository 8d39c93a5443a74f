// Fits the parameters to measured curves through an emulator: likelihood, most probable set, posterior.
//
// The comparison is made on the scale T(y) = ln(1 + y / s) of every output: about linear below s, so that the
// mean over packings, some of which collapse early, stays the mean of strain, and logarithmic above. With r =
// T(measured) - emulator mean at x, r is normal with the covariance
//   emulator(x) + packing(x) · packing_share + diag(T'² (measurement² + misfit²)),
// where the measurement's sd is the sample's, or else 1 % of the reading with a floor of 5e-5, and misfit,
// the sd of what the model cannot follow, is estimated along with the parameters.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "experiments/campaign.hpp"
#include "experiments/settings/settings.hpp"
#include "optimizers/posterior.hpp"
#include "surrogate/curve_emulator.hpp"

namespace loam::experiments {

/// The scale on which curves are emulated and compared; `scale` in the output's unit. Soils differ by a
/// factor of a hundred in strain, so each has a scale that follows its own curve (transform_for).
struct OutputTransform {
    double scale = 1e-3;
    double forward(double y) const;  // values below -0.9 scale are held there
    double inverse(double t) const;
    double derivative(double y) const;  // of forward
};

/// Measured values of the fitted outputs.
struct Observation {
    Eigen::VectorXd measured;           // [m] SI
    std::optional<Eigen::VectorXd> sd;  // [m] SI, where stated
    double relative = 0.01;             // where not stated: of the reading, and not below
    double floor = 5e-5;                // the resolution: De Pue et al. 2019 read strain to 5e-5
    double packing_share = 1;           // particles of a run over those of the measured specimen
};

/// The largest of 1e-3, 4e-3, 1.6e-2 … that is not above a quarter of the largest measured value: few
/// different scales, so that samples of one data set can share emulators.
OutputTransform transform_for(const Observation& observation);

/// The emulator of a campaign's fitted outputs and what it was trained on.
struct TrainedEmulator {
    surrogate::CurveEmulator emulator;
    OutputTransform transform;
    Eigen::Index runs = 0;
};

/// Trains on the runs that succeeded: outputs `columns` of each, transformed. Throws std::runtime_error when
/// too few did.
TrainedEmulator train_emulator(const std::vector<RunRecord>& runs, const ParameterSpace& space,
                               const std::vector<Eigen::Index>& columns, const OutputTransform& transform,
                               const Settings& settings);

struct Fit {
    Eigen::VectorXd estimate;           // [d] most probable coordinates in the unit cube
    double misfit = 0;                  // sd of what the model cannot follow, at the estimate (SI)
    double log_posterior = 0;           // at the estimate, up to a constant
    optimizers::Posterior posterior;    // draws [n x d+1]: coordinates, then misfit's
    Eigen::MatrixXd covariance;         // [m x m] of the residuals at the estimate, transformed scale
    double emulator_share = 0;          // of the residuals' variance, mean over the posterior's draws
    optimizers::Summary global, local;  // of the search for the estimate
};

/// Global search (NLopt), least-squares refinement (Ceres) and posterior. Deterministic under the settings'
/// seed.
Fit fit(const TrainedEmulator& trained, const ParameterSpace& space, const Observation& observation,
        const Settings& settings);

/// Whether the data narrowed the prior: the central 90 % interval of the posterior, on the parameter's own
/// scale, is less than three quarters as wide as the prior's.
bool is_identified(double posterior_width, double prior_width);

/// Draws' quantile of each column: linear interpolation of the order statistics.
double quantile(std::vector<double> values, double q);

}  // namespace loam::experiments
