#include "experiments/diagnosis/parameter_sets.hpp"

namespace loam::experiments {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Set {
    VectorXd x;
    Gaussian posterior;
};

Set fitted_to(const FittedModel& model, const HeldOutGroup& group, const VectorXd& start) {
    Set out;
    out.x = most_probable(model, group.outputs, start);
    // Where the set lies at a bound, the posterior of the linear model goes beyond: it says how strongly.
    const LinearModel linear = linearised(model, out.x);
    const MatrixXd slope = linear.jacobian(group.outputs, Eigen::all);
    const MatrixXd weighted = MatrixXd(linear.noise(group.outputs, group.outputs)).ldlt().solve(slope);
    const MatrixXd precision =
        slope.transpose() * weighted + MatrixXd(linear.prior_sd.cwiseAbs2().cwiseInverse().asDiagonal());
    out.posterior.covariance = precision.ldlt().solve(MatrixXd::Identity(precision.rows(), precision.cols()));
    out.posterior.mean =
        model.prior_mean + out.posterior.covariance * (weighted.transpose() * linear.residual(group.outputs));
    return out;
}

}  // namespace

std::vector<ComparedSets> compare_groups(const FittedModel& model, const std::vector<HeldOutGroup>& groups,
                                         const VectorXd& start) {
    std::vector<Set> sets;
    for (const HeldOutGroup& group : groups) sets.push_back(fitted_to(model, group, start));
    const VectorXd prior_precision = model.prior_sd.cwiseAbs2().cwiseInverse();
    std::vector<ComparedSets> out;
    for (std::size_t a = 0; a < groups.size(); ++a)
        for (std::size_t b = a + 1; b < groups.size(); ++b)
            out.push_back(
                {groups[a].name, groups[b].name, sets[a].x, sets[b].x,
                 compare_sets(sets[a].posterior, sets[b].posterior, prior_precision, model.prior_mean)});
    return out;
}

}  // namespace loam::experiments
