#include "experiments/workflows/diagnosis_outcome.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "experiments/diagnosis/next_test.hpp"
#include "experiments/diagnosis/parameter_sets.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using nlohmann::json;

/// The regions of largest |z| above the threshold, in words: "deviatoric stress of FILE at its peak (measured
/// above)".
std::string where(const Search& search, std::size_t most) {
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < search.regions.size(); ++k)
        if (std::abs(search.location.z[static_cast<Index>(k)]) > search.location.threshold)
            order.push_back(k);
    std::ranges::sort(order, std::greater{},
                      [&](std::size_t k) { return std::abs(search.location.z[static_cast<Index>(k)]); });
    std::string out;
    for (std::size_t k = 0; k < std::min(most, order.size()); ++k) {
        const Region& region = search.regions[order[k]];
        std::string channel = region.channel;
        std::ranges::replace(channel, '_', ' ');
        out += fmt::format("{}{} of {} in the region {} ({} the model)", out.empty() ? "" : ", ", channel,
                           region.test, region.name,
                           search.location.z[static_cast<Index>(order[k])] > 0 ? "above" : "below");
    }
    return out.empty() ? "no single region, but all of them together" : out;
}

std::string sentence_of(const Diagnosis& d, const Outcome& outcome) {
    const Search& first = d.first;
    switch (outcome.kind) {
        case VerdictKind::none: {
            std::string seen;
            for (const Probe& probe : first.probes)
                if (probe.usual_strength > 0 && probe.detectable_strength <= probe.usual_strength)
                    seen += (seen.empty() ? "" : ", ") + probe.print.effect;
            return fmt::format(
                "No disagreement: the calibrated model follows the measurements within their noise (p = "
                "{:.2g}). {}",
                first.location.p_value,
                seen.empty()
                    ? "These data are too few to show any effect of a usual strength, so that this says "
                      "little."
                    : fmt::format("They would have shown, at a usual strength: {}.", seen));
        }
        case VerdictKind::named:
            return fmt::format(
                "The model lacks {}. Without it the measurements disagree with it (p = {:.1g}): {}.",
                fmt::join(outcome.effects, " and "), first.location.p_value, where(first, 2));
        case VerdictKind::ambiguous:
            return fmt::format("The model fails (p = {:.1g}): {}. What is missing is one of: {}; {}.",
                               first.location.p_value, where(first, 2), fmt::join(outcome.effects, ", "),
                               first.verdict.reason);
        case VerdictKind::outside_library:
            return fmt::format(
                "The model fails (p = {:.1g}): {}. None of the effects known here explains it: {}.",
                first.location.p_value, where(first, 3), first.verdict.reason);
    }
    return "";
}

json number(double value) {
    return std::isfinite(value) ? json(value) : json(nullptr);
}

json regions_json(const std::vector<Region>& regions, const Location& location) {
    json out = json::array();
    for (std::size_t k = 0; k < regions.size(); ++k) {
        const double z = location.z[static_cast<Index>(k)];
        out.push_back({{"test", regions[k].test},
                       {"channel", regions[k].channel},
                       {"region", regions[k].name},
                       {"z", z},
                       {"sign", z > 0   ? 1
                                : z < 0 ? -1
                                        : 0}});
    }
    return out;
}

/// The estimates of the leader's model by name, SI, and the strength of its effect among them.
json estimates_json(const Leader& leader) {
    const ParameterSpace& space = leader.model->campaign.space();
    const Eigen::VectorXd values = space.physical(leader.model->estimate);
    json parameters = json::object(), strength = nullptr;
    for (std::size_t p = 0; p < space.parameters.size(); ++p)
        parameters[std::string(space.parameters[p].name)] = values[static_cast<Index>(p)];
    if (!leader.effect->parameters.empty())
        strength = parameters[std::string(leader.effect->parameters.front().name)];
    return {{"parameters", parameters}, {"strength", strength}};
}

json candidates_json(const Search& search) {
    std::vector<json> out;
    for (std::size_t k = 0; k < search.probes.size(); ++k) {
        const Probe& probe = search.probes[k];
        json entry{{"effect", probe.print.effect},
                   {"log_score", probe.explained.log_evidence},
                   {"probability", 0.0},
                   {"stage", "fingerprint"},
                   {"group", search.table.group[k]},
                   {"explained", probe.explained.chi_squared},
                   {"detectable_strength", number(probe.detectable_strength)},
                   {"never_detectable", std::isinf(probe.detectable_strength)},
                   {"usual_strength", probe.usual_strength}};
        for (std::size_t l = 0; l < search.leaders.size(); ++l) {
            const Leader& leader = search.leaders[l];
            if (leader.effect != probe.effect) continue;
            entry.update(estimates_json(leader));
            entry.update({{"log_score", leader.finalist.log_evidence},
                          {"probability", search.probabilities[l]},
                          {"stage", "ensemble"},
                          {"held_out_gain", leader.finalist.held_out_gain},
                          {"fit_p", leader.finalist.fit_p},
                          {"physical", leader.finalist.is_physical},
                          {"present", leader.finalist.is_present},
                          {"regions", regions_json(leader.regions, leader.location)},
                          {"gap", leader.held_out.empty() ? json(nullptr) : json(gap(leader.held_out))}});
        }
        out.push_back(std::move(entry));
    }
    std::ranges::stable_sort(out, [](const json& a, const json& b) {
        const bool ensemble = a["stage"] == "ensemble", other = b["stage"] == "ensemble";
        if (ensemble != other) return ensemble;
        return a["log_score"].get<double>() > b["log_score"].get<double>();
    });
    return out;
}

json held_out_json(const std::vector<HeldOutScore>& scores) {
    json out = json::array();
    for (const HeldOutScore& s : scores)
        out.push_back({{"test", s.name},
                       {"gap", std::sqrt(s.squares / static_cast<double>(s.outputs))},
                       {"log_score", s.log_score}});
    return out;
}

/// A fitted set by name, SI.
json set_json(const ParameterSpace& space, const Eigen::VectorXd& x) {
    const Eigen::VectorXd values = space.physical(x);
    json out = json::object();
    for (Index k = 0; k < space.dimension(); ++k)
        out[std::string(space.info(k).name)] =
            values[static_cast<Index>(space.fitted[static_cast<std::size_t>(k)])];
    return out;
}

/// The sets of each pair of kinds of test, by the base model and by what the diagnosis ends with.
json sets_json(const Diagnosis& d, const Outcome& outcome) {
    const auto pairs_of = [](const StudiedModel& model) {
        return compare_groups(model.fitted, tests_by_kind(model), model.estimate);
    };
    const auto entry = [](const StudiedModel& model, const ComparedSets& sets) {
        return json{{"p_value", sets.agreement.p_value},
                    {"statistic", sets.agreement.statistic},
                    {"degrees", sets.agreement.degrees},
                    {"parameters",
                     {{sets.first, set_json(model.campaign.space(), sets.of_first)},
                      {sets.second, set_json(model.campaign.space(), sets.of_second)}}}};
    };
    const bool changed = outcome.model != d.base;
    const std::vector<ComparedSets> before = pairs_of(*d.base);
    const std::vector<ComparedSets> after = changed ? pairs_of(*outcome.model) : std::vector<ComparedSets>{};
    json out = json::array();
    for (std::size_t k = 0; k < before.size(); ++k)
        out.push_back({{"kinds", {before[k].first, before[k].second}},
                       {"before", entry(*d.base, before[k])},
                       {"after", changed ? entry(*outcome.model, after[k]) : json(nullptr)}});
    return out;
}

}  // namespace

Outcome outcome_of(const Diagnosis& d, const lab_data::Sample& sample) {
    Outcome out;
    out.kind = d.first.verdict.kind;
    out.effects = d.first.verdict.effects;
    out.model = d.base;
    const Leader* last = nullptr;
    if (out.kind == VerdictKind::named) last = d.first.leader(out.effects.front());
    if (d.second && d.second->verdict.kind == VerdictKind::named) {
        out.kind = VerdictKind::named;
        out.effects = {d.on_top_of, d.second->verdict.effects.front()};
        last = d.second->leader(out.effects.back());
    }
    if (last) {
        out.model = last->model.get();
        out.held_out = last->held_out;
    }
    const std::vector<std::string> rivals =
        out.kind == VerdictKind::ambiguous ? out.effects : std::vector<std::string>{};
    if (out.kind == VerdictKind::ambiguous || out.kind == VerdictKind::outside_library)
        out.next_test = next_test(rivals, measured_tests(sample.tests));
    out.sentence = sentence_of(d, out);
    return out;
}

json diagnosis_result(const Diagnosis& d, const Outcome& outcome, std::uint64_t seed) {
    json out;
    out["verdict"] = to_string(outcome.kind);
    out["effects"] = outcome.effects;
    out["text"] = outcome.sentence;
    out["p_value"] = d.first.location.p_value;
    out["threshold"] = d.first.location.threshold;
    out["regions"] = regions_json(d.first.regions, d.first.location);
    out["candidates"] = candidates_json(d.first);
    if (d.second) {
        out["second_search"] = {{"on_top_of", d.on_top_of}, {"candidates", candidates_json(*d.second)}};
    }
    const bool can = !d.first.held_out.empty(), has_after = can && !outcome.held_out.empty();
    const double before = can ? gap(d.first.held_out) : 0, after = has_after ? gap(outcome.held_out) : 0;
    out["gap_before"] = can ? json(before) : json(nullptr);
    out["gap_after"] = has_after ? json(after) : json(nullptr);
    out["shrink"] = has_after ? json(shrink_of(before, after)) : json(nullptr);
    if (has_after) {
        const GapInterval i = gap_interval(d.first.held_out, outcome.held_out, seed);
        out["gap_before_90"] = {i.before_low, i.before_high};
        out["gap_after_90"] = {i.after_low, i.after_high};
        out["shrink_90"] = {i.shrink_low, i.shrink_high};
    }
    out["sets"] = sets_json(d, outcome);
    out["next_test"] = outcome.next_test ? json(*outcome.next_test) : json(nullptr);
    return out;
}

json diagnosis_document(const Diagnosis& d, const Outcome& outcome) {
    json out;
    json names = json::array(), cosines = json::array(), sizes = json::array();
    for (std::size_t k = 0; k < d.first.probes.size(); ++k) {
        names.push_back(d.first.probes[k].print.effect);
        sizes.push_back(d.first.table.size[static_cast<Index>(k)]);
        const Eigen::VectorXd row = d.first.table.cosines.row(static_cast<Index>(k)).transpose();
        cosines.push_back(std::vector<double>(row.begin(), row.end()));
    }
    out["fingerprints"] = {{"names", names}, {"size", sizes}, {"cosines", cosines}};
    out["held_out_before"] = held_out_json(d.first.held_out);
    out["held_out_after"] = held_out_json(outcome.held_out);
    return out;
}

}  // namespace loam::experiments
