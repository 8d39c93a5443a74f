#include "experiments/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "experiments/ensemble/run_seed.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Places of the runs in the ensemble: every run's index, and with it its randomness, follows from its
// purpose.
constexpr std::uint64_t rounds_from = 2'000'000, round_size = 10'000, confirmations_from = 3'000'000,
                        rounds_of_a_task = 20;
constexpr std::uint64_t confirmation_packings = 2;  // of run_seed

/// A direct run, on a packing that no emulator is trained on.
RunSpec confirmation_spec(const Campaign& campaign, std::uint64_t index, const VectorXd& parameters) {
    RunSpec out = training_spec(campaign, index, "confirmation", parameters);
    out.packing_seed = run_seed(campaign.settings().seed, index, confirmation_packings);
    return out;
}

/// Number of a round of a task among all rounds.
std::uint64_t round_number(const CalibrationTask& task, int round) {
    return rounds_of_a_task * task.place + static_cast<std::uint64_t>(round);
}

/// The curves [n x m] of the direct runs at the estimate, transformed.
MatrixXd direct_curves(const Calibration& c) {
    return transformed_curves(c.confirmation, c.columns, c.trained->transforms);
}

/// The estimate with the mean of its direct runs.
TriedSet tried(const Calibration& c, int round) {
    const MatrixXd curves = direct_curves(c);
    return {c.fit.estimate, curves.colwise().mean().transpose(), static_cast<double>(curves.rows()), round};
}

/// Runs where they are worth most (sets_to_add).
std::vector<RunSpec> added_runs(const Campaign& campaign, const Fit& fit, std::uint64_t round, bool follows) {
    const Settings& settings = campaign.settings();
    const std::uint64_t first = round * round_size;
    const MatrixXd sets =
        sets_to_add(fit, settings.calibration.runs_per_round, follows, settings.seed, first);
    std::vector<RunSpec> specs;
    for (Index k = 0; k < sets.rows(); ++k)
        specs.push_back(training_spec(campaign, rounds_from + first + static_cast<std::uint64_t>(k),
                                      "training", campaign.space().physical(sets.row(k).transpose())));
    return specs;
}

/// Compares the emulator with the mean of the direct runs, at the estimate.
CalibrationRound compare(const Campaign& campaign, const Calibration& c, const Observation& observation) {
    CalibrationRound round;
    round.runs = c.trained->runs;
    round.check = check_emulator(c.fit, *c.trained, observation, direct_curves(c));
    round.emulator_share = c.fit.emulator_share;
    round.text = fmt::format(
        "{} runs: direct runs differ from the emulator by {:.2f} of what is tolerable, which would shift {} "
        "by "
        "{:.2f} standard deviations (limit {:.2f}); the emulator makes {:.0f} % of the residuals' variance",
        round.runs, round.check.difference, campaign.space().info(round.check.parameter).name,
        round.check.shift, round.check.limit, 100 * round.emulator_share);
    return round;
}

/// Appends runs about the fit, and the direct runs, to those that the next emulator is trained on;
/// of direct runs on packings on which sets are compared only that they fail.
void add_runs(Campaign& campaign, const Calibration& c, std::vector<RunRecord>& runs, int round,
              const CalibrationTask& task) {
    for (RunRecord& run : campaign.run(task.title + "added runs",
                                       added_runs(campaign, c.fit, round_number(task, round), task.follows)))
        runs.push_back(std::move(run));
    for (const RunRecord& run : c.confirmation)
        if (task.packings.empty() || !run.ok) runs.push_back(run);
}

/// Makes the direct runs of a round, at the estimate, `times` as many as usual.
void confirm(Campaign& campaign, Calibration& c, int round, const CalibrationTask& task, int times = 1) {
    c.confirmation =
        direct_runs(campaign, campaign.space().physical(c.fit.estimate), round_number(task, round),
                    times * campaign.settings().calibration.confirmation_packings, task.title, task.packings);
}

/// Sums the direct runs up and appends how the emulator compares with them.
void judge(const Campaign& campaign, Calibration& c, const Observation& observation) {
    c.simulated = mean_outputs(c.confirmation);
    c.replicate_sd = sd_outputs(c.confirmation);
    c.rounds.push_back(compare(campaign, c, observation));
}

/// Where the emulator never became sure, its most probable set is no better than what it does not know: takes
/// that of the sets tried which is the most probable by direct runs, by twice as many where they leave
/// several in question: the mean of twelve runs of sand that collapses is as uncertain as they differ. As
/// those runs have chosen it, and by luck among other things, it is confirmed by others.
void take_best(Campaign& campaign, Calibration& c, const std::vector<TriedSet>& sets,
               const Observation& observation, const CalibrationTask& task) {
    const Settings& settings = campaign.settings();
    const std::vector<std::size_t> foremost =
        in_question(densities_by_runs(sets, *c.trained, campaign.space(), observation, settings));
    const int times = foremost.size() > 1 ? 2 : 1;
    std::vector<TriedSet> finalists;
    for (const std::size_t k : foremost) finalists.push_back(sets[k]);
    if (times > 1)
        for (TriedSet& set : finalists) {
            c.fit.estimate = set.x;
            confirm(campaign, c, set.round, task, times);  // half of them are there
            set = tried(c, set.round);
        }
    const std::size_t best = choose(c.fit, finalists, *c.trained, campaign.space(), observation, settings);
    confirm(campaign, c, settings.calibration.max_rounds + 1, task, times);
    judge(campaign, c, observation);
    c.rounds.back().text += fmt::format(
        "; the estimate of round {}, of {} the most probable by its direct runs, which leave {} "
        "in question",
        finalists[best].round + 1, sets.size(), finalists.size());
}

void warn_of_disagreement(Calibration& c) {
    if (!c.rounds.back().check.agrees())
        c.warnings.push_back("emulator and direct runs still disagree at the estimate: " +
                             c.rounds.back().text);
}

void warn_of_failures(const std::vector<RunRecord>& runs, Calibration& c) {
    const auto failed = std::ranges::count_if(runs, [](const RunRecord& run) { return !run.ok; });
    if (10 * failed < static_cast<std::ptrdiff_t>(runs.size())) return;
    const auto first = std::ranges::find_if(runs, [](const RunRecord& run) { return !run.ok; });
    c.warnings.push_back(
        fmt::format("{} of {} runs failed (the first: {}); parameters like theirs are held to be impossible",
                    failed, runs.size(), first->reason));
}

/// `apart`: of bring_to_estimate.
void warn_of_search(const Campaign& campaign, Index apart, Calibration& c) {
    const optimizers::Posterior& p = c.fit.posterior;
    if (p.rhat.maxCoeff() > 1.05 || p.ess_bulk.minCoeff() < 200)
        c.warnings.push_back(
            fmt::format("the posterior's chains have not settled (R-hat {:.3f}, effective draws {:.0f})",
                        p.rhat.maxCoeff(), p.ess_bulk.minCoeff()));
    if (const double share = c.rounds.back().emulator_share; share > tolerable_share)
        c.warnings.push_back(
            fmt::format("the emulator makes {:.0f} % of the residuals' variance: the intervals are wide, or "
                        "lie apart from the estimate, for want of runs (--runs, calibration.max_rounds)",
                        100 * share));
    if (apart >= 0)
        c.warnings.push_back(fmt::format(
            "the posterior lies where the emulator knows least, apart from the estimate of {}: the intervals "
            "are by an emulator that is everywhere as sure as it typically is between its runs; more rounds "
            "(calibration.max_rounds) are needed",
            campaign.space().info(apart).name));
    if (const Index k = outside_posterior(c.fit, reported_interval); k >= 0)
        c.warnings.push_back(
            fmt::format("the interval of {} does not hold its estimate", campaign.space().info(k).name));
    for (Index k = 0; k < campaign.space().dimension(); ++k)
        if (is_at_a_bound(c.fit.estimate[k]))
            c.warnings.push_back(fmt::format("{} lies at the bound of its prior; wider bounds may fit better",
                                             campaign.space().info(k).name));
}

}  // namespace

VectorXd mean_outputs(const std::vector<RunRecord>& runs) {
    VectorXd sum;
    double n = 0;
    for (const RunRecord& run : runs) {
        if (!run.ok) continue;
        if (n == 0) sum = VectorXd::Zero(run.outputs.size());
        sum += run.outputs;
        n += 1;
    }
    if (n == 0) throw std::runtime_error("every direct run failed; the first reason: " + runs.at(0).reason);
    return sum / n;
}

VectorXd sd_outputs(const std::vector<RunRecord>& runs) {
    const VectorXd mean = mean_outputs(runs);
    VectorXd sum = VectorXd::Zero(mean.size());
    double n = 0;
    for (const RunRecord& run : runs) {
        if (!run.ok) continue;
        sum += (run.outputs - mean).cwiseAbs2();
        n += 1;
    }
    return (sum / std::max(1.0, n - 1)).cwiseSqrt();
}

std::vector<RunRecord> direct_runs(Campaign& campaign, const VectorXd& parameters, std::uint64_t round,
                                   int count, const std::string& title,
                                   const std::vector<std::uint64_t>& packings) {
    std::vector<RunSpec> specs;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
        specs.push_back(confirmation_spec(campaign, confirmations_from + round * round_size + k, parameters));
        if (k < packings.size()) specs.back().packing_seed = packings[k];
    }
    return campaign.run(title + "direct runs", specs);
}

Calibration calibrate(Campaign& campaign) {
    const CalibrationTask task;
    std::vector<RunRecord> runs = narrowing_runs(campaign, {&task, 1});
    return calibrate(campaign, runs);
}

Calibration calibrate(Campaign& campaign, std::vector<RunRecord>& runs, const CalibrationTask& task) {
    Calibration c;
    const Observation observation = observation_of(campaign, c.columns, task.kinds);
    if (c.columns.empty()) throw std::runtime_error("every test is held out: nothing is left to fit");
    if (campaign.space().dimension() == 0)
        throw std::runtime_error(
            "every parameter is fixed: nothing is left to fit; loam simulate runs the tests");
    const std::vector<OutputTransform> transforms = transforms_of(observation);
    const int last = campaign.settings().calibration.max_rounds;
    std::vector<TriedSet> sets;
    for (int round = 0; round <= last; ++round) {
        c.trained.emplace(train_emulator(runs, campaign.space(), c.columns, transforms, campaign.settings()));
        c.fit = fit(*c.trained, campaign.space(), observation, campaign.settings());
        if (task.follows && round < last && (round == 0 || !is_sure(c.fit))) {
            add_runs(campaign, c, runs, round, task);
            continue;
        }
        confirm(campaign, c, round, task);
        if (round < last && std::ranges::none_of(c.confirmation, &RunRecord::ok)) {
            // The emulator knew nothing there; now it is known that runs fail.
            c.rounds.push_back(
                {.runs = c.trained->runs,
                 .text = "every direct run at the estimate failed: " + c.confirmation[0].reason});
            add_runs(campaign, c, runs, round, task);
            continue;
        }
        judge(campaign, c, observation);
        sets.push_back(tried(c, round));
        const CalibrationRound& now = c.rounds.back();
        // An emulator trained by a design alone is not yet trusted, as direct runs at one point say too
        // little of it: the first rounds of seven-test samples passed them, and the next moved the parameters
        // by 1 to 1.3 standard deviations.
        if ((round > 0 || task.follows) && now.check.agrees() && is_sure(c.fit)) {
            c.stopped_by = "the emulator agrees with direct runs and is a small part of the uncertainty";
            break;
        }
        if (round == last) {
            c.stopped_by = "the number of rounds allowed";
            if (task.chooses && sets.size() > 1) take_best(campaign, c, sets, observation, task);
            warn_of_disagreement(c);
            break;
        }
        add_runs(campaign, c, runs, round, task);
    }
    const Index apart = bring_to_estimate(c.fit);
    warn_of_failures(runs, c);
    warn_of_search(campaign, apart, c);
    return c;
}

}  // namespace loam::experiments
