#include "experiments/diagnosis/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/diagnosis/probes.hpp"
#include "experiments/diagnosis/thresholds.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/output/storage_error.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::uint64_t locate_stream = 21;
constexpr double one_sided_95 = 1.6449;

/// Degrees of freedom behind the covariance of measured minus simulated. Half of the runs tell of the
/// packings' noise, the others go into the emulator; and only a share of the variance has been estimated at
/// all, whose square divides them (Satterthwaite 1946).
double noise_freedom(const StudiedModel& model) {
    const VectorXd all = model.linear.noise.diagonal();
    const VectorXd packing =
        model.calibration.trained->emulator.noise().covariance(model.estimate).diagonal() *
        (model.observation.packing_share + 1.0 / static_cast<double>(model.direct.size()));
    const double share = std::min(1.0, packing.cwiseQuotient(all).mean());
    return 0.5 * static_cast<double>(model.calibration.trained->runs) / (share * share);
}

LocateOptions locate_options(const StudiedModel& model) {
    LocateOptions out;
    out.false_alarm_rate = model.settings().diagnosis.false_alarm_rate;
    out.draws = thresholds::null_draws;
    out.seed = run_seed(model.settings().seed, 0, locate_stream);
    out.noise_freedom = noise_freedom(model);
    return out;
}

/// Standard deviations [d] of the parameters in the unit cube, by the linear model.
VectorXd parameter_sd(const LinearModel& linear) {
    const MatrixXd information = linear.jacobian.transpose() * linear.noise.ldlt().solve(linear.jacobian) +
                                 MatrixXd(linear.prior_sd.cwiseAbs2().cwiseInverse().asDiagonal());
    return information.inverse().diagonal().cwiseSqrt();
}

/// Whether no parameter lies at a bound where the base's lay inside, and the strength stays below its
/// largest.
bool is_physical(const StudiedModel& base, const StudiedModel& model) {
    for (Index k = 0; k < model.estimate.size(); ++k) {
        const double x = model.estimate[k];
        const bool is_new = k >= base.estimate.size();
        if (!is_at_a_bound(x)) continue;
        if (is_new ? x > 0.5 : !is_at_a_bound(base.estimate[k])) return false;
    }
    return true;
}

bool is_present(const ModelEffect& effect, const StudiedModel& model) {
    const ParameterSpace& space = model.campaign.space();
    for (Index k = 0; k < space.dimension() && !effect.parameters.empty(); ++k) {
        if (space.info(k).name != effect.parameters.front().name) continue;
        // On a logarithmic scale nothing is 0; its place is that of the least strength.
        const double none = space.is_logarithmic(k) ? 0.0 : space.prior(k).to_unit(0);
        const double away = std::abs(model.estimate[k] - none);
        return away > one_sided_95 * parameter_sd(model.linear)[k];
    }
    return true;
}

double total(const std::vector<HeldOutScore>& scores) {
    double sum = 0;
    for (const HeldOutScore& score : scores) sum += score.log_score;
    return sum;
}

/// An effect whose runs fail is no reason to give up the others; a full disk or the user's mistake is.
void or_leave_out(const ModelEffect& effect, Search& search, const std::function<void()>& work) {
    try {
        work();
    } catch (const lab_data::UserError&) {
        throw;
    } catch (const StorageError&) {
        throw;
    } catch (const std::runtime_error& error) {
        search.warnings.push_back(fmt::format("{} is left out: {}", effect.name, error.what()));
    }
}

void probe_all(Search& search, const StudiedModel& base, const lab_data::Sample& sample,
               const std::filesystem::path& folder, RunLog* log, const StepReport& report) {
    const Projection projection(base.linear);
    for (const ModelEffect* effect : candidates_for(base.settings(), base.campaign)) {
        report(fmt::format("fingerprint of {}", effect->name));
        or_leave_out(*effect, search, [&] {
            Probe probe = probe_effect(base, *effect, sample, folder, log);
            probe.explained = explain(projection, probe.print, probe.usual_strength);
            search.probes.push_back(std::move(probe));
        });
    }
    std::vector<Fingerprint> prints;
    for (const Probe& probe : search.probes) prints.push_back(probe.print);
    search.table = compare_fingerprints(projection, prints, thresholds::same_group_cosine);
}

/// Where the model fails the most, and how much.
std::string failure(const Location& at, const std::vector<Region>& regions) {
    Index worst = 0;
    at.z.cwiseAbs().maxCoeff(&worst);
    const Region& region = regions[static_cast<std::size_t>(worst)];
    return fmt::format(
        "p = {:.2g}, largest |z| {:.1f} (threshold {:.1f}), measured {} the model: {} of {}, {}", at.p_value,
        std::abs(at.z[worst]), at.threshold, at.z[worst] > 0 ? "above" : "below", region.channel, region.test,
        region.name);
}

/// What the effects but one would change.
std::vector<Direction> directions_of(const Search& search, const ModelEffect* but = nullptr) {
    std::vector<Direction> out;
    for (const Probe& probe : search.probes)
        if (probe.effect != but) out.push_back({probe.print.change, probe.print.two_sided});
    return out;
}

/// Whether the effect's strength 0 is not the base: freed rotation comes with it. What it does is then no
/// small change, and its fingerprint at one strength says little of what its best strength explains.
bool is_beyond_fingerprints(const ModelEffect& effect, const Settings& base) {
    return effect.needs_rotation() && base.rotation != "free";
}

void test_base(Search& search, const StudiedModel& base) {
    const Projection projection(base.linear);
    const std::vector<Direction> directions = directions_of(search);
    search.location = locate(projection, search.regions, locate_options(base), directions);
    const MatrixXd scores = region_scores(projection, search.regions),
                   directed = direction_scores(projection, directions);
    for (std::size_t k = 0; k < search.probes.size(); ++k) {
        Probe& probe = search.probes[k];
        // What freed rotation changes does not grow with the strength.
        if (is_beyond_fingerprints(*probe.effect, base.settings()) && !probe.effect->parameters.empty()) {
            probe.detectable_strength = NAN;
            continue;
        }
        probe.detectable_strength =
            probe.print.strength * detectable_strength(scores,
                                                       directed.row(static_cast<Index>(k)).transpose(),
                                                       search.location, probe.print.change);
    }
}

/// Places of the probes to try: those that lead, best first, and before them those that their fingerprint
/// cannot rule out, as only what has been tried can leave others no chance.
std::vector<std::size_t> leading(const Search& search, const Settings& base) {
    const int most = base.diagnosis.leaders;
    const auto beyond = [&](std::size_t k) { return is_beyond_fingerprints(*search.probes[k].effect, base); };
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < search.probes.size(); ++k)
        if (search.probes[k].explained.chi_squared >= thresholds::least_explained &&
            search.table.size[static_cast<Index>(k)] >= thresholds::least_visible)
            out.push_back(k);
    std::ranges::stable_sort(out, std::greater{},
                             [&](std::size_t k) { return search.probes[k].explained.chi_squared; });
    out.resize(std::min(out.size(), static_cast<std::size_t>(most)));
    for (std::size_t k = 0; k < search.probes.size(); ++k)
        if (beyond(k) && std::ranges::find(out, k) == out.end()) out.push_back(k);
    std::ranges::stable_partition(out, beyond);
    return out;
}

/// Whether a leader so far leaves this probe no chance.
bool is_ruled_out(const Search& search, std::size_t at, const Settings& base) {
    const Probe& probe = search.probes[at];
    std::vector<Finalist> so_far;
    for (const Leader& leader : search.leaders) so_far.push_back(leader.finalist);
    return !search.held_out.empty() && !is_beyond_fingerprints(*probe.effect, base) &&
           is_hopeless(0.5 * probe.explained.chi_squared, so_far);
}

Leader lead(const Search& search, std::size_t at, StudiedModel& base, const lab_data::Sample& sample,
            const std::filesystem::path& folder, RunLog* log) {
    const ModelEffect& effect = *search.probes[at].effect;
    const Settings settings = settings_with(base.settings(), effect);
    Leader out{&effect, {}, {}, {}, {}, {}};
    const ParameterSpace space = parameter_space(settings);
    out.model = study_model(settings, sample, folder_of(folder, effect), log,
                            runs_without(base, effect, space), window_with(base, space));
    const Projection projection(out.model->linear);
    out.regions = regions_of(*out.model);
    out.location =
        locate(projection, out.regions, locate_options(*out.model), directions_of(search, &effect));
    if (!search.held_out.empty())
        out.held_out =
            predict_held_out(out.model->fitted, tests_to_hold_out(*out.model), out.model->estimate);
    Finalist& f = out.finalist;
    f.effect = effect.name;
    f.group = search.table.group[at];
    f.is_mundane = effect.is_mundane();
    f.log_evidence = projection.log_evidence() - Projection(base.linear).log_evidence();
    f.held_out_gain = total(out.held_out) - total(search.held_out);
    f.gap = gap(out.held_out);
    f.gap_shrinks =
        out.held_out.empty() || error_over_noise(out.held_out) < error_over_noise(search.held_out);
    f.fit_p = out.location.p_value;
    f.is_physical = is_physical(base, *out.model);
    f.is_present = is_present(effect, *out.model);
    return out;
}

}  // namespace

const Leader* Search::leader(std::string_view effect) const {
    const auto at = std::ranges::find_if(leaders, [&](const Leader& l) { return l.effect->name == effect; });
    return at == leaders.end() ? nullptr : &*at;
}

std::vector<const ModelEffect*> candidates_for(const Settings& settings, const Campaign& campaign) {
    const auto contains = [](const std::vector<std::string>& names, std::string_view name) {
        return std::ranges::find(names, name) != names.end();
    };
    std::vector<const ModelEffect*> out;
    for (const ModelEffect& effect : model_effects()) {
        const bool wanted =
            settings.diagnosis.candidates.empty() || contains(settings.diagnosis.candidates, effect.name);
        const bool is_in = contains(settings.effects, effect.name) ||
                           (effect.origin == EffectOrigin::rotation && settings.rotation == "free");
        const bool shows = std::ranges::any_of(campaign.tests(), [&](const CampaignTest& test) {
            return !test.held_out && (!effect.touches || effect.touches(test.test->kind));
        });
        const bool possible =
            effect.goes_with(settings.law) &&
            !(effect.needs_fragile() && settings.law == "linear-cohesive" && !settings.engine.fragile);
        if (wanted && possible && !is_in && shows) out.push_back(&effect);
    }
    return out;
}

Search search_for_effect(StudiedModel& base, const lab_data::Sample& sample,
                         const std::filesystem::path& folder, RunLog* log, const StepReport& report) {
    Search out;
    out.regions = regions_of(base);
    const std::vector<HeldOutGroup> groups = tests_to_hold_out(base);
    const bool can_hold_out = groups.size() > 1;
    if (can_hold_out) out.held_out = predict_held_out(base.fitted, groups, base.estimate);
    probe_all(out, base, sample, folder, log, report);
    test_base(out, base);
    report("where the model fails: " + failure(out.location, out.regions));
    if (out.location.alarm)
        for (const std::size_t k : leading(out, base.settings())) {
            if (is_ruled_out(out, k, base.settings())) {
                report(fmt::format("{} explains too little to be tried beside what fits",
                                   out.probes[k].effect->name));
                continue;
            }
            report(fmt::format("ensemble with {}", out.probes[k].effect->name));
            or_leave_out(*out.probes[k].effect, out, [&] {
                out.leaders.push_back(lead(out, k, base, sample, folder, log));
                const Leader& leader = out.leaders.back();
                report(fmt::format(
                    "the model with {}: {}{}", leader.effect->name, failure(leader.location, leader.regions),
                    can_hold_out ? fmt::format("; held-out gain {:.1f}", leader.finalist.held_out_gain)
                                 : ""));
            });
        }
    std::vector<Finalist> finalists;
    for (const Leader& leader : out.leaders) finalists.push_back(leader.finalist);
    out.verdict = decide(out.location.alarm, can_hold_out, finalists);
    out.probabilities = probabilities(finalists);
    return out;
}

}  // namespace loam::experiments
