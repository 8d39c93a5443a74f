// Whether each kind of test, fitted alone, asks for the same parameters: a model that lacks something takes
// what is missing out of its parameters, and differently for each kind. Sets that come together when an
// effect is added speak for it.
#pragma once

#include "experiments/cross_test.hpp"
#include "experiments/diagnosis/held_out.hpp"

namespace loam::experiments {

/// The most probable sets [d] (unit cube) by two groups of outputs, each alone.
struct ComparedSets {
    std::string first, second;  // names of the groups
    Eigen::VectorXd of_first, of_second;
    Agreement agreement;  // of second minus first, from the model made linear at each set
};

/// Every pair of the groups. The fits begin at `start` [d].
std::vector<ComparedSets> compare_groups(const FittedModel& model, const std::vector<HeldOutGroup>& groups,
                                         const Eigen::VectorXd& start);

}  // namespace loam::experiments
