/// The free variables of a box, mapped to the unit cube.
///
/// NLopt's and Ceres' tolerances and first steps are absolute or relative to x itself; on the unit cube they
/// mean the same in every direction of any box. Variables with equal bounds are taken out: neither library
/// accepts them.
#pragma once

#include <vector>

#include "optimizers/problem.hpp"

namespace loam::optimizers {

class ScaledBox {
  public:
    /// `bounds` must have been validated.
    explicit ScaledBox(const Bounds& bounds) : bounds_(bounds) {
        for (Eigen::Index i = 0; i < bounds.size(); ++i) {
            if (bounds.lower(i) < bounds.upper(i)) free_.push_back(i);
        }
    }

    /// Number of free variables, k.
    Eigen::Index size() const { return static_cast<Eigen::Index>(free_.size()); }
    /// Index in x of each free variable [k].
    const std::vector<Eigen::Index>& free() const { return free_; }
    /// Width of the box along the free variable j.
    double width(Eigen::Index j) const {
        const Eigen::Index i = free_[static_cast<std::size_t>(j)];
        return bounds_.upper(i) - bounds_.lower(i);
    }

    /// x [d] at the scaled point z [k]; always inside the bounds, whatever the rounding (or the caller) did
    /// to z.
    Vector to_x(const Vector& z) const {
        Vector x = bounds_.lower;
        for (Eigen::Index j = 0; j < size(); ++j) {
            const Eigen::Index i = free_[static_cast<std::size_t>(j)];
            x(i) = z(j) < 1 ? x(i) + z(j) * width(j) : bounds_.upper(i);  // rounding must not miss the bound
        }
        return bounds_.clamp(x);
    }

    /// z [k] of x [d], inside [0, 1].
    Vector to_z(const Vector& x) const {
        Vector z(size());
        for (Eigen::Index j = 0; j < size(); ++j) {
            const Eigen::Index i = free_[static_cast<std::size_t>(j)];
            z(j) = (x(i) - bounds_.lower(i)) / width(j);
        }
        return z.cwiseMax(0.0).cwiseMin(1.0);
    }

  private:
    Bounds bounds_;
    std::vector<Eigen::Index> free_;
};

}  // namespace loam::optimizers
