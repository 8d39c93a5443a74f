#include "experiments/diagnosis/probes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/settings/parameters.hpp"
#include "experiments/settings/validation.hpp"
#include "surrogate/kernels/registry.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::uint64_t fingerprints_from = 20'000'000, runs_of_a_trial = 1000;  // indices of their runs
constexpr Index fewest_pairs = 2;
constexpr int leader_rounds = 1;  // of added runs in an effect's own ensemble
// A fingerprint is looked for at up to so many strengths until it is so many noises long: a few packings
// scatter by some three in the mean, and what is shorter says little of the direction.
constexpr int most_strengths = 3;
constexpr double long_enough = 6, nearly = 0.7;
constexpr double weaker = 0.2;  // what is tried of a strength with which too many runs failed
// What an effect explains, the base's parameters have stood in for: they may shift by so much of their scale.
// A modulus with bounds of 1 MPa and 10 GPa by a factor of four.
constexpr double shift_by_effect = 0.15;

double root_mean_square(const surrogate::Prior& prior) {
    constexpr int points = 200;
    double sum = 0;
    for (int k = 0; k < points; ++k)
        sum += std::pow(prior.from_unit(prior.quantile_unit((k + 0.5) / points)), 2) / points;
    return std::sqrt(sum);
}

/// The base model's parameters with the effect's behind them: its strength, and the rest as the space has
/// them.
VectorXd with_strength(const VectorXd& base, const ParameterSpace& space, double strength) {
    VectorXd out = space.values;
    out.head(base.size()) = base;
    if (out.size() > base.size()) out[base.size()] = strength;
    return out;
}

/// Whether the effect holds the base model: at a strength of 0 that its prior allows.
bool holds_base(const ModelEffect& effect, const Settings& base, const surrogate::Prior* prior) {
    const bool same_rotation = !effect.needs_rotation() || base.rotation == "free";
    return prior && same_rotation && prior->lower <= 0 && prior->upper >= 0;
}

std::vector<RunSpec> specs_with(const StudiedModel& base, const ParameterSpace& space, double strength,
                                std::uint64_t trial) {
    std::vector<RunSpec> specs;
    const int wanted = base.settings().diagnosis.fingerprint_packings;
    for (const RunRecord& run : base.direct) {
        if (!run.ok || static_cast<int>(specs.size()) >= wanted) continue;
        RunSpec spec = run.spec;
        spec.index = fingerprints_from + trial * runs_of_a_trial + specs.size();
        spec.purpose = "fingerprint";
        spec.parameters = with_strength(run.spec.parameters, space, strength);
        specs.push_back(std::move(spec));
    }
    return specs;
}

}  // namespace

const surrogate::Prior* prior_of_strength(const ModelEffect& effect, const ParameterSpace& space) {
    if (effect.parameters.empty()) return nullptr;
    for (Index k = 0; k < space.dimension(); ++k)
        if (space.info(k).name == effect.parameters.front().name) return &space.prior(k);
    return nullptr;
}

Settings settings_with(const Settings& base, const ModelEffect& effect) {
    Settings out = base;
    add_effect(out, effect);
    out.runs = std::max(base.diagnosis.runs, fewest_training_runs(static_cast<int>(out.priors.size())));
    // The base's runs without the effect, or its fit, have settled most of it.
    out.calibration.max_rounds = std::min(out.calibration.max_rounds, leader_rounds);
    if (holds_base(effect, base, prior_of_strength(effect, parameter_space(out))))
        out.calibration.replicates = (out.calibration.replicates + 1) / 2;
    return out;
}

std::filesystem::path folder_of(const std::filesystem::path& folder, const ModelEffect& effect) {
    return folder / "effects" / std::string(effect.name);
}

Probe probe_effect(const StudiedModel& base, const ModelEffect& effect, const lab_data::Sample& sample,
                   const std::filesystem::path& folder, RunLog* log) {
    const std::filesystem::path place = folder_of(folder, effect);
    std::filesystem::create_directories(place);
    Campaign campaign(settings_with(base.settings(), effect), sample, place, log);
    Probe out;
    out.effect = &effect;
    out.print.effect = effect.name;
    double most = out.print.strength;
    if (const surrogate::Prior* prior = prior_of_strength(effect, campaign.space())) {
        out.print.two_sided = prior->from_unit(0) < 0;
        out.print.strength = prior->from_unit(prior->quantile_unit(out.print.two_sided ? 0.84 : 0.5));
        out.usual_strength = root_mean_square(*prior);
        most = prior->from_unit(prior->quantile_unit(0.95));
    }
    const Projection projection(base.linear);
    double next = out.print.strength;
    bool has_change = false;
    for (std::uint64_t trial = 0; trial < most_strengths; ++trial) {
        EffectChange change;
        try {
            change = change_with(base, effect, campaign, next, trial);
        } catch (const TooFewRuns& error) {  // so much of it cannot be simulated
            if (!has_change && (trial + 1 == most_strengths || effect.parameters.empty())) throw;
            out.runs += error.runs;
            out.failed += error.failed;
            if (has_change) break;
            most = next / 2;
            next *= weaker;
            continue;
        }
        has_change = true;
        out.print.strength = next;
        out.print.change = change.mean();
        out.runs += change.runs;
        out.failed += change.failed;
        const double length = length_of(projection, change);
        out.print.runs = std::move(change);
        if (length >= nearly * long_enough || next >= nearly * most) break;
        next = std::min(most, next * std::clamp(long_enough / std::max(length, 1e-3), 1.5, 5.0));
    }
    return out;
}

EffectChange change_with(const StudiedModel& base, const ModelEffect& effect, Campaign& campaign,
                         double strength, std::uint64_t trial) {
    const std::vector<RunSpec> specs = specs_with(base, campaign.space(), strength, trial);
    const std::vector<RunRecord> runs = campaign.run(fmt::format("fingerprint of {}", effect.name), specs);
    EffectChange out{
        Eigen::MatrixXd(base.linear.residual.size(), static_cast<Index>(runs.size())), {}, runs.size(), 0};
    Index pairs = 0;
    for (const RunRecord& run : runs) {
        const auto same = std::ranges::find_if(base.direct, [&](const RunRecord& other) {
            return other.ok && other.spec.packing_seed == run.spec.packing_seed;
        });
        if (!run.ok || same == base.direct.end()) continue;
        out.of_packing.col(pairs++) = transformed(base, run.outputs) - transformed(base, same->outputs);
        out.packings.push_back(run.spec.packing_seed);
    }
    out.failed = runs.size() - static_cast<std::size_t>(pairs);
    if (pairs < fewest_pairs)
        throw TooFewRuns(fmt::format("{} of {} runs with {} failed: {}", out.failed, runs.size(), effect.name,
                                     runs.empty() ? "" : runs.front().reason),
                         runs.size(), out.failed);
    out.of_packing.conservativeResize(Eigen::NoChange, pairs);
    return out;
}

std::vector<RunRecord> runs_without(const StudiedModel& base, const ModelEffect& effect,
                                    const ParameterSpace& space) {
    if (!holds_base(effect, base.settings(), prior_of_strength(effect, space))) return {};
    std::vector<RunRecord> out;
    for (RunRecord& run : base.campaign.store().records()) {
        if (!run.ok || run.spec.purpose == "confirmation" || run.spec.purpose == "fingerprint") continue;
        run.spec.parameters = with_strength(run.spec.parameters, space, 0);
        out.push_back(std::move(run));
    }
    return out;
}

Window window_with(const StudiedModel& base, const ParameterSpace& space) {
    const Index d = base.estimate.size();
    const Window of_base =
        plausible_window(*base.calibration.trained, base.campaign.space(), base.observation, base.settings());
    Window out{VectorXd::Zero(space.dimension()), VectorXd::Ones(space.dimension())};
    out.lower.head(d) =
        of_base.lower.cwiseMin((base.estimate.array() - shift_by_effect).matrix()).cwiseMax(0.0);
    out.upper.head(d) =
        of_base.upper.cwiseMax((base.estimate.array() + shift_by_effect).matrix()).cwiseMin(1.0);
    return out;
}

}  // namespace loam::experiments
