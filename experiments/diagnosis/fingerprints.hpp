// What each effect does to the curves that the parameters cannot undo, and which effects do the same.
#pragma once

#include <string>
#include <vector>

#include "experiments/diagnosis/linear_model.hpp"

namespace loam::experiments {

/// The change of all outputs that an effect makes at the calibrated point.
struct Fingerprint {
    std::string effect;
    Eigen::VectorXd change;  // [m] at the probe's strength
    double strength = 1;     // of the probe, SI
    bool two_sided = false;  // the strength may be negative
};

struct FingerprintTable {
    Eigen::VectorXd size;     // [e] length at the probe's strength after projection, in noises
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
