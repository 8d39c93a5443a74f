// Fits the parameters to measured curves through an emulator: likelihood, most probable set, posterior.
//
// The comparison is made on a scale T of every output (observation.hpp). With r = T(measured) - emulator mean
// at x, r is normal with the covariance
//   emulator(x) + packing(x) · packing_share + diag(T'² measurement²) + misfit,
// where packing noise is common to the channels of one test alone, since the tests of a sample are specimens
// of their own, and misfit, what the model cannot follow, has a size for each kind of test, common to its
// channels, that is estimated along with the parameters. It is correlated along a curve where the observation
// says so: then the number of readings of a curve does not matter, once there are enough to show its shape.
// The probability that the direct runs with these parameters all come to an end is a further factor.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "experiments/campaign.hpp"
#include "experiments/feasibility.hpp"
#include "experiments/observation.hpp"
#include "experiments/settings/settings.hpp"
#include "experiments/window.hpp"
#include "optimizers/posterior.hpp"
#include "surrogate/curve_emulator.hpp"

namespace loam::experiments {

/// The emulator of a campaign's fitted outputs and what it was trained on.
struct TrainedEmulator {
    surrogate::CurveEmulator emulator;
    std::vector<OutputTransform> transforms;  // [m] one for each output
    Eigen::Index runs = 0;
    Feasibility feasibility{};  // parameters with which runs fail are no estimate
};

/// Trains on the runs that succeeded: outputs `columns` of each, transformed. Throws std::runtime_error when
/// too few did.
TrainedEmulator train_emulator(const std::vector<RunRecord>& runs, const ParameterSpace& space,
                               const std::vector<Eigen::Index>& columns,
                               const std::vector<OutputTransform>& transforms, const Settings& settings);

struct Fit {
    // [d] coordinates in the unit cube that are expected to be the most probable, by StrainMisfit::nearest:
    // where the model cannot follow a curve, those that come nearest. The posterior is by
    // StrainMisfit::along: with one along the curve many other sets are as good.
    Eigen::VectorXd estimate;
    Eigen::VectorXd
        misfits;  // sizes of what the model cannot follow, at the estimate: ObservedCurve::misfit_sd
    double log_posterior = 0;         // at the estimate, up to a constant
    optimizers::Posterior posterior;  // draws [n x d+misfits]: coordinates, misfits'
    // The posterior were the emulator as sure everywhere as it typically is between its runs: not drawn to
    // where it knows nothing and so excludes nothing.
    optimizers::Posterior plausible;
    // By the density that the estimate maximises: where the curves come near, by what the emulator knows.
    optimizers::Posterior near;
    Eigen::MatrixXd covariance;         // [m x m] of the residuals at the estimate, transformed scale
    double emulator_share = 0;          // of the residuals' variance, mean over the posterior's draws
    optimizers::Summary global, local;  // of the search for the estimate
};

/// Within the plausible window: global search (NLopt), least-squares refinement (Ceres) and posterior.
/// Deterministic under the settings' seed.
Fit fit(const TrainedEmulator& trained, const ParameterSpace& space, const Observation& observation,
        const Settings& settings);

/// Coordinates [d] at which direct runs were made, and the mean [m] of their curves, transformed.
struct TriedSet {
    Eigen::VectorXd x, mean;
    double runs = 0;
    int round = 0;  // of the calibration that tried it
};

/// Log density [k] of each of the sets, up to a constant: by its direct runs in place of the emulator, at its
/// most probable misfits.
std::vector<double> densities_by_runs(const std::vector<TriedSet>& sets, const TrainedEmulator& trained,
                                      const ParameterSpace& space, const Observation& observation,
                                      const Settings& settings);

/// Makes that of the sets the fit's estimate which is the most probable by its direct runs; the posterior
/// stays. Returns its place. Throws std::invalid_argument when there are none.
std::size_t choose(Fit& fit, const std::vector<TriedSet>& sets, const TrainedEmulator& trained,
                   const ParameterSpace& space, const Observation& observation, const Settings& settings);

/// Where the parameters are plausible: the window about Fit::plausible.
Window plausible_window(const TrainedEmulator& trained, const ParameterSpace& space,
                        const Observation& observation, const Settings& settings);

/// Whether the data narrowed the prior: the central 90 % interval of the posterior, on the parameter's own
/// scale, is less than three quarters as wide as the prior's.
bool is_identified(double posterior_width, double prior_width);

}  // namespace loam::experiments
