// Every number that a verdict of the diagnosis hangs on, with where it comes from. Frozen: to change one,
// make the development twins anew and say here what they showed.
#pragma once

#include "experiments/observation.hpp"

namespace loam::experiments::thresholds {

// What two sound DEM models of one soil differ by for reasons that no effect stands for: rate of loading,
// size and number of particles, another code. Against YADE on the same packings (README, "How it is checked")
// the curves of stress differ by 0.04 to 1.1 %, those of volumetric strain by up to 0.2 % of the largest one,
// oedometers by up to 1e-3 of strain. Taken as a smooth error along each curve: a share of the reading, and a
// floor in the curve's unit (strain; the cell pressure or normal stress).
inline constexpr double tolerance_share = 0.01;
inline constexpr double tolerance_strain = 1e-4;  // axial strain of an oedometer
inline constexpr double tolerance_volume = volume_between_codes;
inline constexpr double tolerance_stress = stress_between_codes;
inline constexpr double tolerance_length =
    0.5;  // over which it is correlated, of a curve by the root of strain

// Of the null draws from which the false-alarm rate is worked out: at the default rate of 0.5 % the threshold
// rests on 100 of them.
inline constexpr int null_draws = 20'000;

// Share of each output's variance that scores along fingerprints take for independent noise, so that nothing
// hangs on combinations of readings of whose small variance some tens of runs tell little. On linear-Gaussian
// toys with the noise estimated from 60 runs the false-alarm rate then holds.
inline constexpr double directed_ridge = 0.1;

// The model that is named must pass the test by which the base failed. It is fitted to the same data with one
// more parameter and tested after being chosen, so that a smaller p than that of the base's test is no alarm
// yet.
inline constexpr double fit_p = 0.001;

// Two effects whose projected fingerprints have a cosine above this are one group: the part of a fingerprint
// that is its own is then sqrt(1 - 0.9^2) = 0.44 of it, and at a strength of six noises, "medium", stands
// only 2.6 above the noise: below what is called significant here.
inline constexpr double same_group_cosine = 0.9;

// A fingerprint below one noise at every strength that was tried cannot be seen in these tests.
inline constexpr double least_visible = 1;

// Leaders are effects that explain at least this much of the whitened projected residual's square: a z
// of 2.5.
inline constexpr double least_explained = 6.25;

// Once an effect fits and predicts, no ensemble is made for one whose fingerprint explains less than this
// share of the first one's evidence, and less by this many nats. Of 59 ensembles (64 twins of loam bench
// diagnose at seed 1, 8 at seed 2, twin_coarse_sand, twin_medium_sand) six gained more than five times what
// their fingerprint explains, two of them rolling resistance with freed rotation, which is always tried; none
// where another effect fitted and this rule would have changed the verdict.
inline constexpr double hopeless_share = 0.2;
inline constexpr double hopeless_lag = 20;

// Log score of held-out curves (nats) by which a named model must beat the base: odds of 150 to 1, "decisive"
// in Jeffreys' scale (1961) ...
inline constexpr double gain_over_base = 5;
// ... and the runner-up of another group: odds of 20 to 1.
inline constexpr double gain_over_rival = 3;
// A mundane explanation (apparatus, density) that fits as well is named first, and is a rival at odds of up
// to 400 to 1.
inline constexpr double gain_over_mundane_rival = 6;

// Beyond noise, in noises, by which a named model may still miss curves that were left out. Of the first 48
// twins of loam bench diagnose at seed 1, models that were named rightly missed them by 0 to 1.25, and three
// of four named wrongly by 1.7 to 2.4.
inline constexpr double largest_gap = 1.5;

// A second effect is looked for where a first one predicts better but does not yet fit; it must gain more,
// for two names are two chances to be wrong: the same odds of 150 to 1 after twenty pairs were tried.
inline constexpr double gain_of_second = 8;

// Power at which the smallest strength that these data would have shown is stated: the 90 % quantile of a
// normal.
inline constexpr double detection_quantile = 1.2816;

}  // namespace loam::experiments::thresholds
