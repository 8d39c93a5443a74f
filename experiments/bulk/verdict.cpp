#include "experiments/bulk/verdict.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double swelling = 5e-4;       // m/m: more than a reading's noise
constexpr double early_share = 0.6;     // of the strain, at the first of several stages
constexpr double scatter_share = 0.5;   // of the error, that the packings' scatter explains
constexpr double emulator_share = 0.5;  // of the error, from which on it is the emulator's
constexpr double beyond_strain = 0.35;  // where De Pue et al. (2019) leave a run out

std::string bound_met(const FittedSample& fit, const ParameterSpace& space) {
    for (Index k = 0; k < space.dimension(); ++k)
        if (is_at_a_bound(fit.estimate[k]))
            return fmt::format("{} lies at the {} bound of its prior", space.info(k).name,
                               fit.estimate[k] < 0.5 ? "lower" : "upper");
    return {};
}

/// In words, where the simulated curve lies beside the measured one.
std::string shape_of_error(const VectorXd& error) {
    const Index half = error.size() / 2;
    const double low = error.head(half).mean(), high = error.tail(error.size() - half).mean();
    const auto side = [](double e) { return e > 0 ? "more" : "less"; };
    return fmt::format("the simulated specimen strains {} than the measured one at low stress and {} at high",
                       side(low), side(high));
}

double root_mean_square(const VectorXd& difference) {
    return std::sqrt(difference.squaredNorm() / static_cast<double>(difference.size()));
}

/// How far (m/m) direct runs are from the method's own curve; 0 where it has none.
double emulator_error(const SampleOutcome& outcome) {
    if (outcome.fit->predicted.size() == 0) return 0;
    return root_mean_square(outcome.direct->mean - outcome.fit->predicted);
}

/// The packings' scatter (m/m), if it explains the error.
std::optional<double> explaining_scatter(const SampleOutcome& outcome) {
    if (outcome.direct->sd.size() == 0) return std::nullopt;
    const double scatter = root_mean_square(outcome.direct->sd);
    const double runs = static_cast<double>(outcome.direct->curves.size());
    if (scatter > scatter_share * outcome.rmse * std::sqrt(runs)) return scatter;
    return std::nullopt;
}

/// Whether the emulator missed what the model does at the estimate, or the model itself does not follow.
std::string who_is_at_fault(const SampleOutcome& outcome) {
    if (outcome.fit->predicted.size() == 0) return {};
    const double emulator = emulator_error(outcome);
    if (emulator >= emulator_share * outcome.rmse)
        return fmt::format(
            "the emulator is off by {:.1e} m/m at the estimate (more training runs, --runs, mend that): ",
            emulator);
    return "the emulator is right and its best curve is not near: the model cannot follow; ";
}

std::string reason_for(const SampleOutcome& outcome, const ParameterSpace& space) {
    const VectorXd& strain = outcome.sample->curve.strain;
    if (strain.minCoeff() < -swelling)
        return fmt::format(
            "the specimen swelled by {:.1e} m/m before it was compressed, which the model has no "
            "means to do",
            -strain.minCoeff());
    if (strain.maxCoeff() > beyond_strain)
        return fmt::format("the measured strain of {:.2f} is beyond the model's range", strain.maxCoeff());
    const double last = strain[strain.size() - 1];
    if (strain[0] > early_share * last)
        return fmt::format(
            "{:.0f} % of the strain comes at the first stage: a disturbed or badly seated specimen",
            100 * strain[0] / last);
    if (const auto scatter = explaining_scatter(outcome))
        return fmt::format("specimens at the estimate scatter by {:.1e} m/m: they are about to collapse",
                           *scatter);
    const std::string bound = bound_met(*outcome.fit, space);
    const std::string shape = who_is_at_fault(outcome) + shape_of_error(outcome.direct->mean - strain);
    return bound.empty() ? shape : shape + "; " + bound;
}

}  // namespace

bool was_misled(const SampleOutcome& outcome) {
    if (!outcome.direct || !outcome.fit) return false;
    if (outcome.direct->curves.empty()) return true;
    return outcome.rmse > followed_error && !explaining_scatter(outcome) &&
           emulator_error(outcome) >= emulator_share * outcome.rmse;
}

void judge(SampleOutcome& outcome, const ParameterSpace& space) {
    if (!outcome.status.empty()) return;
    if (!outcome.fit) {
        outcome.status = "failed";
        if (outcome.reason.empty()) outcome.reason = "was not fitted";
        return;
    }
    if (outcome.direct && outcome.direct->curves.empty()) {
        outcome.status = "failed";
        outcome.reason = fmt::format(
            "the measured strain reaches {:.2f}; no direct run at the estimate reached the last stage: {}",
            outcome.sample->curve.strain.maxCoeff(), outcome.direct->reason);
        return;
    }
    outcome.status = "calibrated";
    if (!outcome.direct) return;
    outcome.followed = outcome.rmse <= followed_error;
    if (!*outcome.followed) outcome.reason = reason_for(outcome, space);
}

}  // namespace loam::experiments
