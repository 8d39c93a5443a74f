// The test of two parameter sets, on linear models with normal noise, where all is known exactly.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "experiments/cross_test.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// y = J x + noise of unit variance, with a normal prior of x.
struct LinearModel {
    MatrixXd jacobian;

    Gaussian posterior(const VectorXd& data, const VectorXd& precision, const VectorXd& mean) const {
        MatrixXd p = jacobian.transpose() * jacobian;
        p.diagonal() += precision;
        const MatrixXd c = p.llt().solve(MatrixXd::Identity(p.rows(), p.cols()));
        return {c * (jacobian.transpose() * data + precision.cwiseProduct(mean)), c};
    }
};

class CrossTest : public testing::Test {
  protected:
    VectorXd noise(Index n) {
        VectorXd out(n);
        for (double& v : out) v = normal_(random_);
        return out;
    }

    /// Share of data sets whose p-value is below `level` when b's truth is `shift` from a's.
    double rejected(double level, const VectorXd& shift, int repetitions = 2000) {
        const Index d = shift.size(), n = 6;
        const VectorXd precision = VectorXd::Constant(d, 4.0), mean = VectorXd::Constant(d, 0.5);
        std::mt19937_64 of_models(7);
        LinearModel a{MatrixXd(n, d)}, b{MatrixXd(n, d)};
        std::normal_distribution<double> entries(0, 8);
        for (double& v : a.jacobian.reshaped()) v = entries(of_models);
        for (double& v : b.jacobian.reshaped()) v = entries(of_models);
        b.jacobian.col(d - 1).setZero();  // b says nothing of the last parameter
        int below = 0;
        for (int k = 0; k < repetitions; ++k) {
            const VectorXd truth = mean + 0.3 * noise(d);
            const VectorXd y_a = a.jacobian * truth + noise(n), y_b = b.jacobian * (truth + shift) + noise(n);
            const Agreement agreement = compare_sets(a.posterior(y_a, precision, mean),
                                                     b.posterior(y_b, precision, mean), precision, mean);
            EXPECT_GE(agreement.p_value, 0);
            EXPECT_LE(agreement.p_value, 1);
            if (agreement.p_value < level) ++below;
        }
        return static_cast<double>(below) / repetitions;
    }

  private:
    std::mt19937_64 random_{11};
    std::normal_distribution<double> normal_;
};

TEST_F(CrossTest, CallsSetsThatAgreeDifferentAtItsRate) {
    // 2000 repetitions: one binomial sd is 0.0049 at 5 % and 0.0022 at 1 %.
    EXPECT_NEAR(rejected(0.05, VectorXd::Zero(3)), 0.05, 0.015);
    EXPECT_NEAR(rejected(0.01, VectorXd::Zero(3)), 0.01, 0.008);
}

TEST_F(CrossTest, SeesAShiftOfWhatBothKnow) {
    EXPECT_GT(rejected(0.01, Eigen::Vector3d(0.5, 0, 0), 300), 0.9);
}

TEST_F(CrossTest, SaysNothingOfWhatOneDoesNotKnow) {
    EXPECT_LT(rejected(0.01, Eigen::Vector3d(0, 0, 5), 300), 0.05);
}

}  // namespace
}  // namespace loam::experiments
