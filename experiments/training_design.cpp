#include "experiments/training_design.hpp"

#include <algorithm>
#include <stdexcept>

#include "experiments/ensemble/run_seed.hpp"
#include "experiments/fit.hpp"
#include "experiments/settings/validation.hpp"
#include "surrogate/designs.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::uint64_t replicates_from = 1'000'000;  // places in the ensemble
constexpr int packings_per_replicated_point = 4;
constexpr std::uint64_t training_packings = 1, design_stream = 3;  // of run_seed

/// Training shares a pool of packings, large enough that the pool's own mean is no noticeable error.
constexpr std::uint64_t packing_pool = 64;

Window whole(Index d) {
    return {VectorXd::Zero(d), VectorXd::Ones(d)};
}

/// The runs at a design of `count` points in the window; `from`: the place of the first.
std::vector<RunRecord> designed_runs(Campaign& campaign, const Window& window, int count, int from) {
    const Settings& settings = campaign.settings();
    const std::uint64_t seed = run_seed(settings.seed, static_cast<std::uint64_t>(from), design_stream);
    const MatrixXd u = settings.calibration.design == "sobol"
                           ? surrogate::sobol_sequence(count, campaign.space().dimension(), {.seed = seed})
                           : surrogate::maximin_latin_hypercube(count, campaign.space().dimension(), seed);
    const MatrixXd x = from_probabilities(campaign.space(), window, u);
    std::vector<RunSpec> specs;
    for (Index k = 0; k < x.rows(); ++k)
        specs.push_back(training_spec(campaign, static_cast<std::uint64_t>(from + k), "training",
                                      campaign.space().physical(x.row(k).transpose())));
    return campaign.run("training", specs);
}

/// Appends runs on further packings at some of the points of `runs`.
void add_replicates(Campaign& campaign, std::vector<RunRecord>& runs) {
    std::vector<RunSpec> replicates;
    std::vector<const RunRecord*> good;
    for (const RunRecord& run : runs)
        if (run.ok) good.push_back(&run);
    const auto wanted = static_cast<std::size_t>(std::max(0, campaign.settings().calibration.replicates));
    for (std::size_t k = 0; k < std::min(wanted, good.size()); ++k) {
        const VectorXd& parameters = good[k * good.size() / std::min(wanted, good.size())]->spec.parameters;
        for (int p = 0; p < packings_per_replicated_point; ++p)
            replicates.push_back(training_spec(
                campaign,
                replicates_from + k * packings_per_replicated_point + static_cast<std::uint64_t>(p) + 1,
                "replicate", parameters));
    }
    for (RunRecord& run : campaign.run("replicates", replicates)) runs.push_back(std::move(run));
}

/// Where the runs leave the parameters of any of the tasks plausible.
Window plausible(const Campaign& campaign, std::span<const CalibrationTask> tasks,
                 const std::vector<RunRecord>& runs) {
    std::optional<Window> out;
    for (const CalibrationTask& task : tasks) {
        std::vector<Index> columns;
        const Observation observation = observation_of(campaign, columns, task.kinds);
        const TrainedEmulator trained =
            train_emulator(runs, campaign.space(), columns, transforms_of(observation), campaign.settings());
        const Window window = plausible_window(trained, campaign.space(), observation, campaign.settings());
        out = out ? hull(*out, window) : window;
    }
    return *out;
}

}  // namespace

MatrixXd from_probabilities(const ParameterSpace& space, const Window& window, const MatrixXd& u) {
    MatrixXd x(u.rows(), u.cols());
    for (Index k = 0; k < u.cols(); ++k) {
        const surrogate::Prior& prior = space.prior(k);
        const double from = prior.cdf_unit(window.lower[k]), to = prior.cdf_unit(window.upper[k]);
        for (Index r = 0; r < u.rows(); ++r)
            x(r, k) = std::clamp(prior.quantile_unit(from + u(r, k) * (to - from)), window.lower[k],
                                 window.upper[k]);
    }
    return x;
}

RunSpec training_spec(const Campaign& campaign, std::uint64_t index, const char* purpose,
                      const VectorXd& parameters) {
    return {index, purpose, parameters,
            run_seed(campaign.settings().seed, index % packing_pool, training_packings),
            static_cast<std::uint32_t>(campaign.settings().particles)};
}

std::vector<RunRecord> training_runs(Campaign& campaign) {
    std::vector<RunRecord> runs =
        designed_runs(campaign, whole(campaign.space().dimension()), campaign.settings().runs, 0);
    add_replicates(campaign, runs);
    return runs;
}

int first_wave(int runs, int parameters) {
    constexpr int fewest_of_a_second = 10;
    // Some may fail, and the rest must do for an emulator.
    const int first = std::max(fewest_training_runs(parameters) * 5 / 4, runs / 3);
    return runs - first < fewest_of_a_second ? runs : first;
}

std::vector<RunRecord> narrowing_runs(Campaign& campaign, std::span<const CalibrationTask> tasks,
                                      const std::optional<Window>& first,
                                      const std::vector<RunRecord>& known) {
    if (!campaign.settings().calibration.narrowing) return training_runs(campaign);
    const int all = campaign.settings().runs, d = static_cast<int>(campaign.space().dimension());
    const int in_first = first_wave(all, d);
    const Window window = first.value_or(whole(d));
    std::vector<RunRecord> runs = designed_runs(campaign, window, in_first, 0);
    if (in_first < all) {
        std::vector<RunRecord> teachers = runs;
        teachers.insert(teachers.end(), known.begin(), known.end());
        const auto sound = std::ranges::count_if(teachers, &RunRecord::ok);
        const Window next = sound < fewest_training_runs(d) ? window : plausible(campaign, tasks, teachers);
        for (RunRecord& run : designed_runs(campaign, next, all - in_first, in_first))
            runs.push_back(std::move(run));
    }
    add_replicates(campaign, runs);
    return runs;
}

}  // namespace loam::experiments
