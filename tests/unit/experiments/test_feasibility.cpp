// Where runs succeed, learnt from where they did.
#include <gtest/gtest.h>

#include "experiments/feasibility.hpp"
#include "surrogate/designs.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;

TEST(Feasibility, IsCertainWhereNothingFailed) {
    EXPECT_EQ(Feasibility().log_success(Vector2d(0.1, 0.2)), 0);
    const MatrixXd x = surrogate::maximin_latin_hypercube(20, 2, 1);
    EXPECT_EQ(Feasibility(x, std::vector<bool>(20, true)).log_success(Vector2d(0.9, 0.9)), 0);
    EXPECT_EQ(Feasibility(x, std::vector<bool>(20, false)).log_success(Vector2d(0.9, 0.9)), 0);
}

TEST(Feasibility, FindsTheBorderAndGoesOnBeyondTheRuns) {
    // Runs fail above a line; none was made in the corner beyond it.
    const MatrixXd all = surrogate::maximin_latin_hypercube(120, 2, 2);
    std::vector<Index> kept;
    for (Index k = 0; k < all.rows(); ++k)
        if (all(k, 0) < 0.8) kept.push_back(k);
    MatrixXd x(static_cast<Index>(kept.size()), 2);
    std::vector<bool> success;
    for (std::size_t k = 0; k < kept.size(); ++k) {
        x.row(static_cast<Index>(k)) = all.row(kept[k]);
        success.push_back(all(kept[k], 0) + all(kept[k], 1) < 1.1);
    }
    const Feasibility feasibility(x, success);
    EXPECT_GT(feasibility.log_success(Vector2d(0.2, 0.3)), -0.01);
    EXPECT_LT(feasibility.log_success(Vector2d(0.7, 0.8)), -3);
    EXPECT_LT(feasibility.log_success(Vector2d(0.95, 0.95)), -5);
    EXPECT_GT(feasibility.log_success(Vector2d(0.3, 0.5)), feasibility.log_success(Vector2d(0.5, 0.7)));
}

}  // namespace
}  // namespace loam::experiments
