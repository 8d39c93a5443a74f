#include "experiments/workflows/benchmarks/diagnosis_twins.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <ranges>

#include "experiments/calibration.hpp"
#include "experiments/diagnosis/probes.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/settings/parameters.hpp"
#include "experiments/workflows/benchmarks/benchmarks.hpp"
#include "experiments/workflows/benchmarks/twin_tests.hpp"
#include "surrogate/designs.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int soils_with_effects = 3, soils_without = 60, withheld_twins = 20, pairs = 12;
constexpr int hidden_twin_enlargement = 2;
constexpr std::array levels{weak, medium, strong};
constexpr int packings_of_lengths = 8;
constexpr double near_enough = 1.5;  // factor between a length and the one wanted
constexpr int most_trials = 4;       // of strengths, for one effect, soil and length
// Streams of run_seed, and the indices of the soils' own twins.
constexpr std::uint64_t hidden_packings = 31, hidden_noise = 32, soil_design = 33, order = 34, pairing = 35;
constexpr std::size_t plain_from = 900'000;

/// The model that is diagnosed, whatever the command line says of it.
Settings diagnosed_model_of(const Settings& given) {
    using engine::PriorKind;
    const Settings defaults;
    Settings s = given;
    s.law = "linear-damped";
    s.rotation = "free";
    s.effects = {};
    s.set = {{"normal_damping", 0.1}, {"tangential_damping", 0.1}};
    s.priors = {{"young_modulus", {PriorKind::loguniform, 0, 0, 3e7, 5e8}},
                {"stiffness_ratio", {PriorKind::uniform, 0, 0, 0.1, 1.0}},
                {"friction_angle", {PriorKind::uniform, 0, 0, 0.15, 0.6}}};
    if (s.particles == defaults.particles) s.particles = 200;
    if (s.runs == defaults.runs) s.runs = 90;
    s.engine.haste = 3;
    s.calibration.specimen_particles = hidden_twin_enlargement * s.particles;
    s.calibration.max_rounds = 0;
    s.calibration.narrowing = false;  // one design for all soils
    s.calibration.replicates = 6;
    s.calibration.confirmation_packings = 4;
    s.calibration.posterior_draws = 600;
    s.diagnosis.packings = 8;
    s.diagnosis.fingerprint_packings = 4;
    s.diagnosis.leaders = 2;
    s.diagnosis.runs = 60;
    s.quiet = true;
    return s;
}

/// How the twins are made.
Settings twin_of(const Settings& model) {
    Settings s = model;
    s.specimen.size_spread = 0.28;
    s.engine.damping = 0.3;
    s.engine.haste = 1.5;
    s.quiet = false;
    return s;
}

lab_data::Sample shared_tests() {
    lab_data::Sample sample = reference_sample();
    sample.name = "twin";
    sample.tests.clear();
    sample.tests.push_back(
        oedometer_without_readings(5e3, {10e3, 20e3, 40e3, 80e3, 160e3, 320e3, 640e3, 160e3, 40e3}));
    for (const double pressure : {50e3, 200e3}) {
        lab_data::Test test = test_without_readings(
            lab_data::TestKind::triaxial, fmt::format("triaxial_{}kPa.csv", pressure / 1e3), "axial_strain",
            0.1, 12, {"deviatoric_stress", "volumetric_strain"});
        test.cell_pressure = pressure;
        sample.tests.push_back(std::move(test));
    }
    for (lab_data::Test& test : sample.tests) test.initial_void_ratio = 0.68;
    return sample;
}

Settings with_effects(Settings settings, const std::vector<std::string>& effects) {
    for (const std::string& name : effects) add_effect(settings, *find_model_effect(name));
    return settings;
}

/// The parameters (SI) of a twin in the space of its own model.
VectorXd parameters_of(const TwinTruth& twin, const ParameterSpace& base, const VectorXd& soil,
                       const ParameterSpace& space) {
    VectorXd out = space.values;
    out.head(base.values.size()) = base.physical(soil);
    for (std::size_t k = 0; k < twin.effects.size(); ++k) {
        const std::string_view name = find_model_effect(twin.effects[k])->parameters.front().name;
        const auto at = std::ranges::find(space.parameters, name, &engine::ParameterInfo::name);
        out[at - space.parameters.begin()] = twin.strengths[k];
    }
    return out;
}

bool is_near(const TwinTruth& twin) {
    return twin.reached * near_enough >= twin.wanted && twin.reached <= near_enough * twin.wanted;
}

/// The values in an order of chance.
template <class T>
std::vector<T> shuffled(const std::vector<T>& values, std::uint64_t seed, std::uint64_t stream) {
    std::vector<std::pair<std::uint64_t, std::size_t>> places;
    for (std::size_t k = 0; k < values.size(); ++k) places.emplace_back(run_seed(seed, k, stream), k);
    std::ranges::sort(places);
    std::vector<T> out;
    for (const auto& [key, k] : places) out.push_back(values[k]);
    return out;
}

/// Twins with two effects of one soil each, in an order of chance.
std::vector<TwinTruth> pairs_of(const std::vector<TwinTruth>& single, std::uint64_t seed) {
    std::vector<TwinTruth> out;
    for (std::size_t a = 0; a < single.size(); ++a)
        for (std::size_t b = a + 1; b < single.size(); ++b) {
            if (single[a].soil != single[b].soil) continue;
            out.push_back(single[a]);
            out.back().effects.push_back(single[b].effects.front());
            out.back().strengths.push_back(single[b].strengths.front());
        }
    return shuffled(out, seed, pairing);
}

}  // namespace

nlohmann::json to_json(const TwinTruth& t) {
    return {{"name", t.name},     {"soil", t.soil},       {"effects", t.effects},  {"strengths", t.strengths},
            {"wanted", t.wanted}, {"reached", t.reached}, {"withheld", t.withheld}};
}

TwinFactory::TwinFactory(const Settings& given, std::filesystem::path folder, RunLog& log)
    : folder_(std::move(folder)),
      log_(log),
      model_(diagnosed_model_of(given)),
      twin_(twin_of(model_)),
      tests_(shared_tests()) {
    const Index d = parameter_space(model_).dimension();
    const std::uint64_t seed = run_seed(model_.seed, 0, soil_design);
    soils_.resize(soils_with_effects + soils_without, d);
    soils_.topRows(soils_with_effects) = surrogate::maximin_latin_hypercube(soils_with_effects, d, seed);
    soils_.bottomRows(soils_without) = surrogate::maximin_latin_hypercube(soils_without, d, seed + 1);
    soils_ = parameter_space(model_).from_probabilities((0.15 + 0.7 * soils_.array()).matrix());

    Settings shown = model_;
    shown.quiet = false;
    const std::filesystem::path shared = folder_ / "shared";
    Campaign campaign(shown, tests_, shared, &log_);
    training_runs(campaign);
    form_ = observation_of(campaign, columns_);
    effects_ = candidates_for(model_, campaign);
    for (const ModelEffect* effect : effects_) {
        Campaign with(settings_with(shown, *effect), tests_, folder_of(shared, *effect), &log_);
        training_runs(with);
    }
}

void TwinFactory::prepare(const std::filesystem::path& place) const {
    namespace fs = std::filesystem;
    if (fs::exists(place)) return;
    // Half a copy would be taken for all of it.
    const fs::path half = place.string() + ".tmp";
    fs::remove_all(half);
    fs::create_directories(half.parent_path());
    fs::copy(folder_ / "shared", half, fs::copy_options::recursive);
    fs::rename(half, place);
}

std::vector<std::vector<TwinFactory::Strength>> TwinFactory::find_strengths(int soil) {
    TwinTruth plain;
    plain.name = fmt::format("soil-{}", soil);
    plain.soil = soil;
    const lab_data::Sample sample =
        measured(simulate(plain, {plain}, {plain_from + static_cast<std::size_t>(soil)}).at(0), plain.name);
    const std::filesystem::path place = folder_ / "soils" / plain.name;
    prepare(place);
    Settings settings = model_;
    settings.quiet = false;
    settings.diagnosis.packings = settings.diagnosis.fingerprint_packings = packings_of_lengths;
    const auto base = study_model(settings, sample, place, &log_);
    const Projection projection(base->linear);
    std::vector<std::vector<Strength>> out;
    for (const ModelEffect* effect : effects_) {
        Campaign campaign(settings_with(settings, *effect), sample, folder_of(place, *effect), &log_);
        const surrogate::Prior& prior = *prior_of_strength(*effect, campaign.space());
        // About proportional to the strength, but that some effects level off and others begin late.
        double next = prior.from_unit(prior.quantile_unit(0.5));
        if (!(next > 0)) next = prior.from_unit(prior.quantile_unit(0.84));
        double most = 0.95 * prior.upper;
        std::uint64_t trial = 0;
        std::vector<Strength> found;
        for (const double wanted : std::views::reverse(levels)) {
            Strength best;
            for (int k = 0; k < most_trials; ++k) {
                next = std::clamp(next, 1e-3 * most, most);
                double now = 0;
                try {
                    const EffectChange change = change_with(*base, *effect, campaign, next, ++trial);
                    now = std::max(0.1, length_of(projection, change));
                } catch (const TooFewRuns&) {  // so much of it cannot be simulated
                    most = next *= 0.6;
                    continue;
                }
                if (best.value == 0 ||
                    std::abs(std::log(now / wanted)) < std::abs(std::log(best.reached / wanted)))
                    best = {next, now};
                if (std::abs(now / wanted - 1) < 0.2 || (now < wanted && next == most)) break;
                next *= std::clamp(wanted / now, 0.2, 5.0);
            }
            next = best.value / 2;
            found.insert(found.begin(), best);
        }
        out.push_back(std::move(found));
    }
    return out;
}

std::vector<TwinTruth> TwinFactory::plan() {
    std::vector<TwinTruth> out;
    std::vector<std::vector<std::vector<Strength>>> strengths;
    for (int soil = 0; soil < soils_with_effects; ++soil) strengths.push_back(find_strengths(soil));
    std::vector<TwinTruth> strong_ones;
    for (std::size_t effect = 0; effect < effects_.size(); ++effect)
        for (std::size_t soil = 0; soil < soils_with_effects; ++soil)
            for (std::size_t level = 0; level < levels.size(); ++level) {
                const Strength& s = strengths[soil][effect][level];
                const TwinTruth twin{{},        static_cast<int>(soil), {std::string(effects_[effect]->name)},
                                     {s.value}, levels[level],          s.reached,
                                     false};
                if (!is_near(twin)) continue;
                out.push_back(twin);
                if (levels[level] == strong) strong_ones.push_back(twin);
            }
    for (int k = 0; k < soils_without; ++k) {
        TwinTruth plain;
        plain.soil = soils_with_effects + k;
        out.push_back(plain);
    }
    for (std::size_t k = 0; k < withheld_twins && !strong_ones.empty(); ++k) {
        TwinTruth twin = strong_ones[k % strong_ones.size()];  // again in other packings, where there are few
        twin.withheld = true;
        out.push_back(twin);
    }
    std::vector<TwinTruth> both = pairs_of(strong_ones, model_.seed);
    both.resize(std::min<std::size_t>(both.size(), pairs));
    out.insert(out.end(), both.begin(), both.end());
    out = shuffled(out, model_.seed, order);
    for (std::size_t k = 0; k < out.size(); ++k) out[k].name = fmt::format("twin-{:03}", k + 1);
    return out;
}

std::vector<RunRecord> TwinFactory::simulate(const TwinTruth& like, const std::vector<TwinTruth>& twins,
                                             const std::vector<std::size_t>& places) {
    const Settings settings = with_effects(twin_, like.effects);
    const std::string name = like.effects.empty() ? "plain" : fmt::format("{}", fmt::join(like.effects, "+"));
    Campaign campaign(settings, tests_, folder_ / "measurements" / name, &log_);
    const ParameterSpace base = parameter_space(model_);
    std::vector<RunSpec> specs;
    for (std::size_t k = 0; k < twins.size(); ++k)
        specs.push_back(
            {places[k], "twin",
             parameters_of(twins[k], base, soils_.row(twins[k].soil).transpose(), campaign.space()),
             run_seed(settings.seed, places[k], hidden_packings),
             static_cast<std::uint32_t>(hidden_twin_enlargement * settings.particles)});
    return campaign.run(fmt::format("twins with {}", name), specs);
}

lab_data::Sample TwinFactory::measured(const RunRecord& run, const std::string& name) const {
    if (!run.ok) throw std::runtime_error(fmt::format("{} could not be made: {}", name, run.reason));
    lab_data::Sample out = tests_;
    out.name = name;
    const Observation noisy =
        observed(form_, columns_, run, run_seed(model_.seed, run.spec.index, hidden_noise));
    Index at = 0;
    for (lab_data::Test& test : out.tests)
        for (const TestChannel& channel : lab_test(test.kind).channels)
            for (double& value : test.columns.at(std::string(channel.name))) value = noisy.measured[at++];
    return out;
}

std::vector<lab_data::Sample> TwinFactory::measure(std::vector<TwinTruth>& twins) {
    std::vector<std::optional<lab_data::Sample>> made(twins.size());
    std::map<std::vector<std::string>, std::vector<std::size_t>> groups;
    for (std::size_t k = 0; k < twins.size(); ++k) groups[twins[k].effects].push_back(k);
    for (const auto& [effects, places] : groups) {
        std::vector<TwinTruth> group;
        for (const std::size_t k : places) group.push_back(twins[k]);
        const std::vector<RunRecord> runs = simulate(group.front(), group, places);
        for (std::size_t k = 0; k < places.size(); ++k) {
            const std::string& twin = twins[places[k]].name;
            if (runs[k].ok)
                made[places[k]] = measured(runs[k], twin);
            else
                log_.write(fmt::format("{} is left out: {}", twin, runs[k].reason));
        }
    }
    std::vector<lab_data::Sample> out;
    std::vector<TwinTruth> kept;
    for (std::size_t k = 0; k < twins.size(); ++k) {
        if (!made[k]) continue;
        out.push_back(std::move(*made[k]));
        kept.push_back(twins[k]);
    }
    twins = std::move(kept);
    return out;
}

}  // namespace loam::experiments
