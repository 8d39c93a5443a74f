// The stages that one shared ensemble is run through, and how a sample's own stages are read off them.
//
// A curve is interpolated on the emulator's scale T(strain) over log stress, by the cubic through the four
// nearest nodes. That is linear in the values at the nodes, so that mean and covariance of a sample's
// readings follow from the emulator's by one matrix. The seating stress, where strain is zero, is a node too.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lab_data/data_set.hpp"

namespace loam::experiments {

/// Of one sample's curve, what is fitted: its loading stages beyond the seating stress.
struct LoadingCurve {
    std::vector<std::size_t> readings;  // [m] of the test
    Eigen::VectorXd stress;             // [m] Pa, rising
    Eigen::VectorXd strain;             // [m] measured
};

/// The readings of the first loading of a test (re-loading and unloading are left out), each above the
/// highest stress before it; empty if there are none.
LoadingCurve loading_curve(const lab_data::Test& test);

struct StageSet {
    double seating_stress = 2000;  // Pa
    std::vector<double> stress;    // [n] Pa, rising, all above the seating stress

    /// [m x n]: the values at these stresses from those at the stages; stresses are within the set's range.
    Eigen::MatrixXd interpolation(const Eigen::VectorXd& at) const;
    /// How many of the stages, counted from the first, the interpolation to stresses up to `highest` needs.
    Eigen::Index needed(double highest) const;
};

/// The stresses of the data set's readable samples if they are at most `most`; else `most` stages from the
/// lowest to the highest, evenly spread over log stress. Throws UserError if no sample has a stage.
StageSet common_stages(const lab_data::DataSet& set, int most);

}  // namespace loam::experiments
