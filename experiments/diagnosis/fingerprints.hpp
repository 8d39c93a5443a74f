// What each effect does to the curves that the parameters cannot undo, and which effects do the same.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/diagnosis/linear_model.hpp"

namespace loam::experiments {

/// What an effect of one strength changes in direct runs, on packings common to base and effect.
struct EffectChange {
    Eigen::MatrixXd of_packing;           // [m x packings] transformed
    std::vector<std::uint64_t> packings;  // their seeds
    std::size_t runs = 0, failed = 0;

    Eigen::VectorXd mean() const { return of_packing.rowwise().mean(); }
};

/// Inner product, after projection, of what two effects change in the mean, from the products of different
/// packings: that of the means themselves is off by what the packings scatter, which two effects have in
/// common where they share packings, and which is in the length of every one, for runs that begin alike soon
/// differ by chance.
double inner_product(const Projection& projection, const EffectChange& one, const EffectChange& other);

/// Length of the mean change in noises, without what the packings scatter; 0 where it drowns in that.
double length_of(const Projection& projection, const EffectChange& change);

/// The change of all outputs that an effect makes at the calibrated point.
struct Fingerprint {
    std::string effect;
    Eigen::VectorXd change;  // [m] at the probe's strength, in the mean
    double strength = 1;     // of the probe, SI
    bool two_sided = false;  // the strength may be negative
    EffectChange runs = {};  // what the mean is of; none: it is exact
};

struct FingerprintTable {
    Eigen::VectorXd size;     // [e] length_of at the probe's strength
    Eigen::MatrixXd cosines;  // [e x e] between the projected fingerprints; 0 for one without length
    std::vector<int> group;   // [e] effects of one number cannot be told apart by these tests
};

/// Groups are chains of pairs whose cosine is above `same_group` (its absolute value, where one of the two
/// has a sign of its own).
FingerprintTable compare_fingerprints(const Projection& projection, const std::vector<Fingerprint>& prints,
                                      double same_group);

/// How well one effect alone, at its best strength, explains the residual in the linear model.
struct Explained {
    double strength = 0;      // SI, at the best; 0 where only the wrong sign would help
    double chi_squared = 0;   // by which r' V^-1 r falls
    double log_evidence = 0;  // over the base's, with the strength's prior N(0, prior_sd^2)
};

/// `prior_sd`: of the strength, SI.
Explained explain(const Projection& projection, const Fingerprint& print, double prior_sd);

}  // namespace loam::experiments
