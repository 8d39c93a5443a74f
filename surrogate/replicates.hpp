// Runs repeated at the same input, gathered: the means carry what is known of the response, the scatter about
// them what is known of the noise, and together they hold all that the single runs do.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace loam::surrogate {

/// Rows of equal inputs. Groups are numbered in the order in which they first appear.
struct ReplicateGroups {
    Eigen::MatrixXd inputs;           ///< [g x d] the distinct inputs
    Eigen::VectorXd count;            ///< [g] rows in each group
    std::vector<Eigen::Index> group;  ///< [n] the group of each row

    Eigen::Index size() const { return inputs.rows(); }
    Eigen::Index rows() const { return static_cast<Eigen::Index>(group.size()); }
    /// Means over the groups, [g x m], of rows [n x m].
    Eigen::MatrixXd means(const Eigen::MatrixXd& rows) const;
    /// Rows minus the mean of their group, [n x m].
    Eigen::MatrixXd deviations(const Eigen::MatrixXd& rows) const;
};

/// Groups the rows of inputs [n x d] that are equal bit for bit.
ReplicateGroups find_replicates(const Eigen::MatrixXd& inputs);

/// Throws std::invalid_argument naming row and column (from 0) of the first entry that is not finite.
void require_finite(const Eigen::MatrixXd& matrix, const char* name);

}  // namespace loam::surrogate
