#include "experiments/workflows/parameter_summary.hpp"

#include <fmt/format.h>

#include <cmath>

#include "experiments/quantile.hpp"

namespace loam::experiments {
namespace {

/// Whether an interval of the unit cube belongs to its estimate. Where it does not, it tells of the
/// emulator's ignorance and not of the parameter; but at a bound of the prior the most probable value lies at
/// the end.
bool holds(double low, double estimate, double high) {
    return is_at_a_bound(estimate) || (low <= estimate && estimate <= high);
}

}  // namespace

Eigen::MatrixXd quantiles_of(const Eigen::MatrixXd& draws) {
    Eigen::MatrixXd out(draws.cols(), 3);
    for (Eigen::Index k = 0; k < draws.cols(); ++k) {
        const Eigen::VectorXd column = draws.col(k);
        const std::vector<double> values(column.begin(), column.end());
        out.row(k) << quantile(values, 0.05), quantile(values, 0.5), quantile(values, 0.95);
    }
    return out;
}

std::vector<ParameterSummary> summarise(const Campaign& campaign, const Fit& fit) {
    return summarise(campaign.space(), fit.estimate, quantiles_of(fit.posterior.draws));
}

std::vector<ParameterSummary> summarise(const ParameterSpace& space, const Eigen::VectorXd& estimate,
                                        const Eigen::MatrixXd& quantiles) {
    const Eigen::VectorXd physical = space.physical(estimate);
    std::vector<ParameterSummary> out;
    for (std::size_t p = 0; p < space.parameters.size(); ++p) {
        const engine::ParameterInfo& info = space.parameters[p];
        ParameterSummary s{std::string(info.name), std::string(info.symbol), std::string(info.unit),
                           std::string(info.meaning)};
        s.estimate = s.q05 = s.q50 = s.q95 = s.prior_q05 = s.prior_q95 =
            physical[static_cast<Eigen::Index>(p)];
        s.fixed = s.identified = true;
        for (Eigen::Index k = 0; k < space.dimension(); ++k) {
            if (space.fitted[static_cast<std::size_t>(k)] != p) continue;
            const surrogate::Prior& prior = space.prior(k);
            const double low = quantiles(k, 0), high = quantiles(k, 2);
            const double prior_low = prior.quantile_unit(0.05), prior_high = prior.quantile_unit(0.95);
            s.q05 = prior.from_unit(low);
            s.q50 = prior.from_unit(quantiles(k, 1));
            s.q95 = prior.from_unit(high);
            s.prior_q05 = prior.from_unit(prior_low);
            s.prior_q95 = prior.from_unit(prior_high);
            s.logarithmic = space.is_logarithmic(k);
            s.fixed = false;
            s.identified = is_identified(high - low, prior_high - prior_low) && holds(low, estimate[k], high);
        }
        out.push_back(std::move(s));
    }
    return out;
}

std::vector<std::string> density_warnings(Campaign& campaign, const std::vector<RunRecord>& runs) {
    std::vector<std::string> out;
    if (runs.empty() || !campaign.settings().packing.empty()) return out;
    const auto void_ratio = [](double n) { return n / (1 - n); };
    for (const CampaignTest& test : campaign.tests()) {
        const auto made = campaign.specimen(test, runs.front().spec);
        if (made->reached) continue;
        out.push_back(fmt::format("{}: the specimen's void ratio is {:.3f}, not the {:.3f} wanted: {}",
                                  test.test->file, void_ratio(made->porosity), void_ratio(test.porosity),
                                  made->stopped_by));
    }
    return out;
}

}  // namespace loam::experiments
