// What was measured, as the likelihood sees it: the readings of all fitted curves in one row, the scale on
// which each is compared, and what is assumed of its noise.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "experiments/campaign.hpp"
#include "surrogate/priors.hpp"

namespace loam::experiments {

// What sound DEM codes differ by on the same packings, at least (README, "How it is checked"): of volumetric
// strain or settlement over height, and of stress over the pressure that confines.
inline constexpr double volume_between_codes = 3e-4, stress_between_codes = 0.01;

/// The scale on which an output is emulated and compared: T(y) = ln(1 + y / scale), about linear below
/// `scale` (in the output's unit), so that the mean over packings, some of which collapse early, stays the
/// mean of the output, and logarithmic above; or T(y) = y / scale for outputs that change their sign.
struct OutputTransform {
    double scale = 1e-3;
    bool linear = false;
    double forward(double y) const;  // logarithmic: values below -0.9 scale are held there
    double inverse(double t) const;
    double derivative(double y) const;  // of forward
    bool operator==(const OutputTransform&) const = default;
};

/// One channel of one test: a stretch of the readings of an observation.
struct ObservedCurve {
    Eigen::Index first = 0, count = 0;
    int test = 0;                              // which specimen
    std::optional<OutputTransform> transform;  // empty: strain, whose scale follows the curve (transform_for)
    double unit = 1;                           // SI; of the numbers below
    double relative = 0.01, floor = 5e-5;  // sd of measurement where not stated: of the reading; not below
    double tolerable_difference = 2.5e-3;  // of emulator and direct runs
    Eigen::Index misfit = 0;               // which of the observation's misfits
    double usual_misfit = 1;               // what those are given in
    double least_misfit = 0;               // whatever their sizes
    // [count] places in 0..1 along which the misfit is correlated; those of the readings themselves where
    // they are strains; else, empty, the misfit is independent.
    Eigen::VectorXd along;
    std::vector<Eigen::Index> phases;  // of strains: the first reading of loading (0), unloading, reloading

    /// Standard deviation (SI) of the misfit, from the sizes of all misfits.
    double misfit_sd(const Eigen::VectorXd& sizes) const {
        return unit * std::hypot(least_misfit, usual_misfit * sizes[misfit]);
    }
};

/// Places in 0..1 of the readings of a curve, by the root of the strain gone through since its start, back
/// and forth: a curve bends most at its start, and what a model errs by in loading it still errs by when
/// unloading.
Eigen::VectorXd places_along(const Eigen::VectorXd& strain);

/// Measured values of the fitted outputs.
struct Observation {
    Eigen::VectorXd measured;           // [m] SI
    std::optional<Eigen::VectorXd> sd;  // [m] SI; NaN where not stated
    double relative = 0.01;             // where not stated, and of one curve of strain: of the reading,
    double floor = 5e-5;                // and not below the resolution (De Pue et al. 2019 read strain to it)
    double packing_share = 1;           // particles of a run over those of the measured specimen
    std::vector<ObservedCurve> curves;  // cover all readings in their order; empty: one curve of strain
    std::vector<surrogate::Prior> misfit_priors;  // of their sizes, see misfit_sd; empty: strain's
};

/// The curves and the misfits' priors, with the defaults in place of nothing.
std::vector<ObservedCurve> curves_of(const Observation& observation);
std::vector<surrogate::Prior> misfit_priors_of(const Observation& observation);
/// Of the misfit of a curve of strain.
const surrogate::Prior& strain_misfit_prior();

/// Of strain: the largest of 1e-3, 4e-3, 1.6e-2 … that is not above a quarter of the largest measured value:
/// few different scales, so that samples of one data set can share emulators. Soils differ by a factor of a
/// hundred in strain, so each has a scale that follows its own curve.
OutputTransform transform_for(const Observation& observation);

/// One for each reading.
std::vector<OutputTransform> transforms_of(const Observation& observation);

/// The measured values of the campaign's fitted outputs, with their columns: of all tests that are not held
/// out, or of those of some kinds alone.
Observation observation_of(const Campaign& campaign, std::vector<Eigen::Index>& columns,
                           std::span<const lab_data::TestKind> kinds = {});

}  // namespace loam::experiments
