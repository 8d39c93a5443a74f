#include "surrogate/replicates.hpp"

#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

namespace loam::surrogate {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd ReplicateGroups::means(const MatrixXd& rows) const {
    MatrixXd means = MatrixXd::Zero(size(), rows.cols());
    for (Index i = 0; i < rows.rows(); ++i) means.row(group[static_cast<std::size_t>(i)]) += rows.row(i);
    return count.cwiseInverse().asDiagonal() * means;
}

MatrixXd ReplicateGroups::deviations(const MatrixXd& rows) const {
    const MatrixXd centre = means(rows);
    MatrixXd deviations = rows;
    for (Index i = 0; i < rows.rows(); ++i)
        deviations.row(i) -= centre.row(group[static_cast<std::size_t>(i)]);
    return deviations;
}

ReplicateGroups find_replicates(const MatrixXd& inputs) {
    std::map<std::vector<double>, Index> seen;
    std::vector<Index> first, count;
    ReplicateGroups groups;
    for (Index i = 0; i < inputs.rows(); ++i) {
        std::vector<double> key(static_cast<std::size_t>(inputs.cols()));
        for (Index k = 0; k < inputs.cols(); ++k) key[static_cast<std::size_t>(k)] = inputs(i, k);
        const auto [entry, fresh] = seen.try_emplace(std::move(key), static_cast<Index>(first.size()));
        if (fresh) {
            first.push_back(i);
            count.push_back(0);
        }
        ++count[static_cast<std::size_t>(entry->second)];
        groups.group.push_back(entry->second);
    }
    const Index size = static_cast<Index>(first.size());
    groups.inputs.resize(size, inputs.cols());
    groups.count.resize(size);
    for (Index g = 0; g < size; ++g) {
        groups.inputs.row(g) = inputs.row(first[static_cast<std::size_t>(g)]);
        groups.count(g) = static_cast<double>(count[static_cast<std::size_t>(g)]);
    }
    return groups;
}

void require_finite(const MatrixXd& matrix, const char* name) {
    for (Index i = 0; i < matrix.rows(); ++i)
        for (Index j = 0; j < matrix.cols(); ++j)
            if (!std::isfinite(matrix(i, j)))
                throw std::invalid_argument(std::string(name) + ": row " + std::to_string(i) + ", column " +
                                            std::to_string(j) + " is " + std::to_string(matrix(i, j)) +
                                            ", but every entry must be a finite number");
}

}  // namespace loam::surrogate
