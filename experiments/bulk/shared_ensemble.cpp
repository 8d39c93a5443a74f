#include "experiments/bulk/shared_ensemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "experiments/ensemble/run_seed.hpp"
#include "surrogate/designs.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Places of the runs in the ensemble, as in calibration.cpp: every run's index follows from its purpose.
constexpr std::uint64_t further_from = 2'000'000, confirmations_from = 1'000'000'000, trial_size = 1000,
                        turn_size = 1'000'000'000;
constexpr std::uint64_t training_packings = 1, confirmation_packings = 2, design_stream = 3;
// Training shares them: their mean differs from that of all packings by a specimen's scatter over the root of
// their number, and that is in every sample.
constexpr std::uint64_t packing_pool = 512;

// Void ratios that make_packing() reaches with 700 particles: 0.56 without friction, 1.03 to 1.04 (by seed)
// with high friction.
constexpr double densest = 0.565, loosest = 1.04;
constexpr double reachable_share = 0.5;  // of the samples, from which on void ratio is an input by itself

bool is_reachable(double void_ratio) {
    return void_ratio >= densest && void_ratio <= loosest;
}

/// The k-th of a sequence that covers 0..1 evenly at every length that is a power of two (van der Corput).
double radical_inverse(std::uint64_t k) {
    double out = 0, digit = 0.5;
    for (; k > 0; k >>= 1, digit *= 0.5) out += digit * static_cast<double>(k & 1);
    return out;
}

}  // namespace

SharedEnsemble::SharedEnsemble(const Settings& settings, const lab_data::DataSet& set,
                               const std::filesystem::path& folder, RunLog* log)
    : stages_(common_stages(set, settings.bulk.stages)) {
    choose_void_ratio(settings, set);
    make_reference(set);
    campaign_ = std::make_unique<Campaign>(settings, reference_, folder, log,
                                           CampaignOptions{void_ratio_, /*keep_partial=*/true});
}

void SharedEnsemble::choose_void_ratio(const Settings& settings, const lab_data::DataSet& set) {
    if (settings.bulk.void_ratio == "off" || settings.specimen.porosity) return;
    std::vector<double> stated;
    std::size_t readable = 0, reachable = 0;
    for (const lab_data::DataSetRow& row : set.rows) {
        if (!row.readable()) continue;
        ++readable;
        const auto& e = std::get<lab_data::Test>(row.test).initial_void_ratio;
        if (!e) continue;
        stated.push_back(std::clamp(*e, densest, loosest));
        if (is_reachable(*e)) ++reachable;
    }
    if (stated.empty()) return;
    const double share = static_cast<double>(reachable) / static_cast<double>(readable);
    if (settings.bulk.void_ratio == "auto" && share < reachable_share) {
        warnings_.push_back(fmt::format(
            "packings of spheres reach the initial void ratio ({} to {}) of {} of {} samples only: it is "
            "not an input, all specimens are made alike",
            densest, loosest, reachable, readable));
        return;
    }
    const auto [low, high] = std::ranges::minmax(stated);
    const double margin = std::max(0.01, 0.05 * (high - low));
    void_ratio_ = {std::max(densest, low - margin), std::min(loosest, high + margin)};
    if (reachable < readable)
        warnings_.push_back(
            fmt::format("{} of {} samples have no initial void ratio or one that packings "
                        "do not reach: the nearest, or the middle of the range, is used",
                        readable - reachable, readable));
}

void SharedEnsemble::make_reference(const lab_data::DataSet& set) {
    reference_.name = set.name;
    reference_.folder = set.folder;
    reference_.measured = set.measured;
    lab_data::Test test;
    test.file = "common stages";
    test.seating_stress = stages_.seating_stress;
    for (const double stage : stages_.stress) {
        test.columns["axial_stress"].push_back(stage);
        test.columns["axial_strain"].push_back(0);
        test.lines.push_back(static_cast<int>(test.lines.size()) + 2);
    }
    reference_.tests.push_back(std::move(test));
}

VectorXd SharedEnsemble::unit(const RunRecord& run) const {
    if (!void_ratio_) return space().unit(run.spec.parameters);
    VectorXd x(inputs());
    x.head(space().dimension()) = space().unit(run.spec.parameters);
    const auto [low, high] = *void_ratio_;
    const double n = run.diagnostics[porosity];
    x[inputs() - 1] = (n / (1 - n) - low) / (high - low);
    return x;
}

double SharedEnsemble::void_ratio_coordinate(const lab_data::Test& test) const {
    if (!void_ratio_) return 0;
    const auto [low, high] = *void_ratio_;
    const double e = test.initial_void_ratio.value_or(0.5 * (low + high));
    return (std::clamp(e, low, high) - low) / (high - low);
}

VectorXd SharedEnsemble::physical(const VectorXd& x, const lab_data::Test& test) const {
    const VectorXd law = space().physical(x);
    if (!void_ratio_) return law;
    VectorXd out(law.size() + 1);
    const auto [low, high] = *void_ratio_;
    out << law, low + void_ratio_coordinate(test) * (high - low);
    return out;
}

RunSpec SharedEnsemble::training_spec(std::uint64_t index, const char* purpose, VectorXd parameters) const {
    const Settings& settings = campaign_->settings();
    const std::uint64_t specimen = index % packing_pool;
    if (void_ratio_) {
        const double at = radical_inverse(specimen) + 0.5 / packing_pool;
        parameters.conservativeResize(parameters.size() + 1);
        parameters[parameters.size() - 1] =
            void_ratio_->first + at * (void_ratio_->second - void_ratio_->first);
    }
    return {index, purpose, std::move(parameters), run_seed(settings.seed, specimen, training_packings),
            static_cast<std::uint32_t>(settings.particles)};
}

/// Makes the runs, those of the stiffest particles first: they take longest, and one that is begun last keeps
/// all cores but its own waiting. Returns them in the order given.
std::vector<RunRecord> SharedEnsemble::run_stiffest_first(const char* title,
                                                          const std::vector<RunSpec>& specs) {
    std::vector<std::size_t> order(specs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t k) {
        return contact_law(campaign_->settings(), specs[k].parameters).young_modulus();
    });
    std::vector<RunSpec> sorted;
    for (const std::size_t k : order) sorted.push_back(specs[k]);
    std::vector<RunRecord> runs = campaign_->run(title, sorted), out(specs.size());
    for (std::size_t k = 0; k < order.size(); ++k) out[order[k]] = std::move(runs[k]);
    return out;
}

std::vector<RunRecord> SharedEnsemble::train_at(const MatrixXd& points, std::uint64_t first) {
    std::vector<RunSpec> specs;
    for (Index k = 0; k < points.rows(); ++k)
        specs.push_back(training_spec(further_from + first + static_cast<std::uint64_t>(k), "training",
                                      space().physical(points.row(k).transpose())));
    return run_stiffest_first("further training", specs);
}

std::optional<std::vector<RunRecord>> SharedEnsemble::stored_further(std::uint64_t first, Index count) const {
    std::vector<RunRecord> out;
    for (Index k = 0; k < count; ++k) {
        std::optional<RunRecord> run =
            campaign_->store().find(further_from + first + static_cast<std::uint64_t>(k));
        if (!run) return std::nullopt;
        out.push_back(std::move(*run));
    }
    return out;
}

std::vector<RunRecord> SharedEnsemble::train(Index n) {
    const Settings& settings = campaign_->settings();
    const Index d = space().dimension();
    const std::uint64_t seed = run_seed(settings.seed, 0, design_stream);
    const MatrixXd u = settings.calibration.design == "sobol"
                           ? surrogate::sobol_sequence(n, d, {.seed = seed})
                           : surrogate::maximin_latin_hypercube(n, d, seed);
    const MatrixXd x = space().from_probabilities(u);
    std::vector<RunSpec> specs;
    for (Index k = 0; k < n; ++k)
        specs.push_back(
            training_spec(static_cast<std::uint64_t>(k), "training", space().physical(x.row(k).transpose())));
    return run_stiffest_first("training", specs);
}

std::vector<std::vector<RunRecord>> SharedEnsemble::confirm(const std::vector<DirectTrial>& trials, int count,
                                                            int turn) {
    const Settings& settings = campaign_->settings();
    std::vector<RunSpec> specs;
    for (const DirectTrial& trial : trials)
        for (int k = 0; k < count; ++k) {
            const std::uint64_t index = confirmations_from + static_cast<std::uint64_t>(turn) * turn_size +
                                        trial.row * trial_size + static_cast<std::uint64_t>(k);
            specs.push_back({index, "confirmation", trial.parameters,
                             run_seed(settings.seed, index, confirmation_packings),
                             static_cast<std::uint32_t>(settings.particles)});
        }
    std::vector<RunRecord> runs = campaign_->run("direct runs", specs);
    std::vector<std::vector<RunRecord>> out(trials.size());
    for (std::size_t k = 0; k < runs.size(); ++k)
        out[k / static_cast<std::size_t>(count)].push_back(std::move(runs[k]));
    return out;
}

}  // namespace loam::experiments
