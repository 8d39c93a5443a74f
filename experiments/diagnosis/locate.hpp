// Where does a calibrated model fail? A score for each region of the curves, of what the parameters cannot
// absorb, a score along what each known effect would change, and one test over all of them whose false-alarm
// rate holds for the whole sample.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/diagnosis/linear_model.hpp"

namespace loam::experiments {

/// A stretch of a curve that was declared before its residuals were looked at.
struct Region {
    std::string test, channel, name;
    std::vector<Eigen::Index> outputs;  // places among the model's
};

/// What an effect that is known would change [m].
struct Direction {
    Eigen::VectorXd change;
    bool two_sided = false;  // it may also change the opposite
};

struct LocateOptions {
    double false_alarm_rate = 0.005;  // of the whole sample
    int draws = 20'000;               // of the null
    std::uint64_t seed = 1;
    // Degrees of freedom behind the covariance of the noise: every null draw is judged by an estimate with as
    // many. 0: the covariance is known.
    double noise_freedom = 0;
};

struct Location {
    Eigen::VectorXd z;         // [regions] positive: measured above the model; 0 where the fit absorbs all
    Eigen::VectorXd directed;  // [directions] positive: as the effect would have it
    double omnibus = 0;        // z' R^-1 z, all regions together
    double p_value = 1;        // of the smallest of the three below, for the whole sample
    double largest_z_p = 1;    // of the largest |z|
    double omnibus_p = 1;
    double directed_p = 1;  // of the largest score along a direction
    // Of |z| and of the directed scores: what is larger raises the alarm.
    double threshold = 0, directed_threshold = 0;
    bool alarm = false;
};

/// Rows [regions x m] that make z of a residual: the mean over the region of what the fit leaves, each output
/// in units of its noise, divided by its standard deviation. (The score test of a shift would be sharper
/// where the noise is known; where it is estimated from some tens of runs it raises three times the alarms
/// that it should.) A row is zero where the parameters absorb the region whole.
Eigen::MatrixXd region_scores(const Projection& projection, const std::vector<Region>& regions);

/// Rows [directions x m] that make the directed scores of a residual: weights of generalised least squares,
/// but that a tenth of each output's variance is taken for independent noise, so that nothing hangs on
/// combinations of readings of whose small variance little is known. Zero for a change that the fit absorbs.
Eigen::MatrixXd direction_scores(const Projection& projection, const std::vector<Direction>& directions);

/// Tests the residual of the projection's model. The null draws are residuals of the model itself with its
/// parameters fitted anew, which in the linear model is the projection. The test is that on the smallest of
/// the p values of the largest |z|, of all z together and of the largest directed score, calibrated by the
/// same draws.
Location locate(const Projection& projection, const std::vector<Region>& regions,
                const LocateOptions& options = {}, const std::vector<Direction>& directions = {});

/// Smallest share of a change [m] that would raise the alarm, in one region or as the direction that is given
/// by its row of scores [m] (may be empty), with a power of 90 %; infinity where it shows in none.
double detectable_strength(const Eigen::MatrixXd& scores, const Eigen::VectorXd& direction,
                           const Location& location, const Eigen::VectorXd& change);

}  // namespace loam::experiments
