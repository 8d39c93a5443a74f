// The statistics of De Pue et al. 2019, section 3, over whatever covariates a data set has: do parameters
// differ between groups of samples, and with what do they go along?
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "experiments/bulk/study.hpp"

namespace loam::experiments {

/// Numbers of the samples that were calibrated, one a sample; NaN: missing.
struct Quantity {
    std::string name, unit;
    Eigen::VectorXd values;
    bool logarithmic = false;  // shown on a log scale
    bool is_result = false;    // of the calibration or the curve, not a covariate
};

struct Group {
    std::string label;
    std::vector<Eigen::Index> members;  // places in Quantity::values
};

/// One covariate that sorts the samples into groups, and what the results say of them.
struct Grouping {
    std::string covariate;
    std::vector<Group> groups;
    std::vector<double> kruskal_p;                  // [results]
    std::vector<std::vector<double>> medians;       // [results][groups]
    std::vector<std::vector<std::string>> letters;  // [results][groups]: equal letters do not differ
    bool paired = false;                            // by signed ranks of pairs instead of ranks
};

struct GroupStatistics {
    std::vector<std::size_t> rows;     // of the data set, one for each of the quantities' values
    std::vector<Quantity> quantities;  // the results first, then the covariates that are numbers
    std::vector<Grouping> groupings;
    Eigen::MatrixXd correlation, significance;  // Spearman's r and p, [quantities x quantities]

    std::size_t results() const;
};

/// Groups are those of a covariate of labels with 2 to 15 different ones, and of one of numbers with few
/// different ones. Pairs of groups are compared at 5 % after Bonferroni's correction: by Mann and Whitney's
/// test, or, where `paired_by` names a covariate that pairs their samples, by Wilcoxon's signed ranks.
GroupStatistics group_statistics(const BulkStudy& study, const lab_data::DataSet& set,
                                 const ParameterSpace& space, const std::string& paired_by);

}  // namespace loam::experiments
