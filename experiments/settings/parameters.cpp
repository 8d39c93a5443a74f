#include "experiments/settings/parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "experiments/settings/conversion.hpp"
#include "experiments/settings/validation.hpp"
#include "lab_data/nearest_name.hpp"

namespace loam::experiments {
namespace {

using engine::ParameterInfo;
using engine::PriorKind;

constexpr std::array<std::string_view, 4> kind_names{"normal", "lognormal", "uniform", "loguniform"};

/// The parameter of that name. Throws UserError for the setting at `origin`.
ParameterInfo parameter_of(const Settings& settings, const std::string& name, const Origin& origin) {
    const std::vector<ParameterInfo> parameters = model_parameters(settings);
    std::vector<std::string_view> valid;
    for (const ParameterInfo& parameter : parameters) {
        if (parameter.name == name) return parameter;
        valid.push_back(parameter.name);
    }
    for (const ModelEffect& effect : model_effects())
        for (const ParameterInfo& parameter : effect.parameters)
            if (parameter.name == name)
                throw fault_at(origin, name, fmt::format("is a parameter of the effect {}", effect.name),
                               fmt::format("add --effects {}", effect.name));
    throw fault_at(origin, name,
                   fmt::format("is not a parameter of the law {}{}", settings.law,
                               settings.effects.empty() ? "" : " with its effects"),
                   lab_data::suggest_name(name, valid));
}

PriorKind kind_of(const std::string& name, const Origin& origin) {
    for (std::size_t i = 0; i < kind_names.size(); ++i)
        if (kind_names[i] == name) return static_cast<PriorKind>(i);
    throw fault_at(origin, name, "is not a kind of prior", lab_data::suggest_name(name, kind_names));
}

Prior prior_from(const ParameterInfo& parameter, const PriorText& text, const Origins& origins) {
    const std::string path = fmt::format("priors.{}", parameter.name);
    const engine::PriorInfo& usual = parameter.prior;
    Prior prior{usual.kind, usual.mean, usual.sd, usual.lower, usual.upper};
    if (text.kind) prior.kind = kind_of(*text.kind, origin_of(origins, path + ".kind"));
    if (prior.kind != usual.kind) prior.mean = prior.sd = 0;
    for (const auto& [name, value] : text.numbers) {
        if (name == "lower") prior.lower = value;
        if (name == "upper") prior.upper = value;
        if (name == "mean") prior.mean = value;
        if (name == "sd") prior.sd = value;
        if ((name == "mean" || name == "sd") && !has_mean(prior.kind))
            throw fault_at(origin_of(origins, path + "." + name), "",
                           fmt::format("has no meaning for a {} prior", to_string(prior.kind)),
                           "leave it out");
    }
    if (has_mean(prior.kind) && prior.kind != usual.kind &&
        !(text.numbers.contains("mean") && text.numbers.contains("sd")))
        throw fault_at(origin_of(origins, path + ".kind"), "",
                       "needs mean and sd when it is not the law's default kind",
                       is_logarithmic(prior.kind) ? "state both, of log10 of the value" : "state both");
    return prior;
}

void check_prior(const ParameterInfo& parameter, const Prior& prior, const Origins& origins) {
    const std::string path = fmt::format("priors.{}", parameter.name);
    const auto demand = [&](bool holds, const char* member, double value, std::string constraint,
                            std::string remedy) {
        if (!holds)
            throw fault_at(origin_of(origins, path + "." + member), fmt::format("{}", value),
                           std::move(constraint), std::move(remedy));
    };
    const std::string range = fmt::format("must lie in the law's range {} to {} {}", parameter.lower,
                                          parameter.upper, parameter.unit);
    const bool logarithmic = is_logarithmic(prior.kind);
    demand(prior.lower >= parameter.lower && prior.lower <= parameter.upper, "lower", prior.lower, range, "");
    demand(prior.upper >= parameter.lower && prior.upper <= parameter.upper, "upper", prior.upper, range, "");
    demand(prior.lower < prior.upper, "lower", prior.lower,
           fmt::format("must be below upper, which is {}", prior.upper),
           fmt::format("to hold the parameter fixed, write {} under [set]", parameter.name));
    demand(!logarithmic || prior.lower > 0, "lower", prior.lower,
           fmt::format("must be above 0 for a {} prior", to_string(prior.kind)), "");
    if (!has_mean(prior.kind)) return;
    demand(prior.sd > 0 && std::isfinite(prior.sd), "sd", prior.sd, "must be above 0",
           fmt::format("to hold the parameter fixed, write {} under [set]", parameter.name));
    const double lower = logarithmic ? std::log10(prior.lower) : prior.lower;
    const double upper = logarithmic ? std::log10(prior.upper) : prior.upper;
    demand(prior.mean >= lower && prior.mean <= upper, "mean", prior.mean,
           fmt::format("must lie between the bounds, {} and {}", lower, upper),
           logarithmic ? "it is of log10 of the value" : "");
}

}  // namespace

std::string_view to_string(PriorKind kind) {
    return kind_names[static_cast<std::size_t>(kind)];
}

bool has_mean(PriorKind kind) {
    return kind == PriorKind::normal || kind == PriorKind::lognormal;
}

bool is_logarithmic(PriorKind kind) {
    return kind == PriorKind::lognormal || kind == PriorKind::loguniform;
}

bool is_fitting(const Settings& settings) {
    constexpr std::array<std::string_view, 4> verbs{"calibrate", "bulk", "crosstest", "diagnose"};
    return std::ranges::find(verbs, settings.verb) != verbs.end();
}

void free_rotation_where_it_is_an_effect(Settings& settings) {
    if (std::ranges::find(settings.effects, "rotation") != settings.effects.end()) settings.rotation = "free";
}

void add_effect(Settings& settings, const ModelEffect& effect) {
    const auto add = [&](std::string_view name) {
        if (std::ranges::find(settings.effects, name) == settings.effects.end())
            settings.effects.emplace_back(name);
    };
    if (effect.needs_rotation() && settings.rotation != "free") add("rotation");
    add(effect.name);
    free_rotation_where_it_is_an_effect(settings);
    for (const ParameterInfo& parameter : effect.parameters) {
        const std::string name(parameter.name);
        if (!std::isnan(parameter.held))
            settings.set.try_emplace(name, parameter.held);
        else if (!settings.set.contains(name))
            settings.priors.try_emplace(name, prior_from(parameter, PriorText{}, Origins{}));
    }
}

std::vector<ParameterInfo> model_parameters(const Settings& settings) {
    const auto of_law = engine::find_law(settings.law)->parameters;
    std::vector<ParameterInfo> out(of_law.begin(), of_law.end());
    for (const std::string& name : settings.effects)
        if (const ModelEffect* effect = find_model_effect(name))
            out.insert(out.end(), effect->parameters.begin(), effect->parameters.end());
    return out;
}

void complete_priors(Settings& settings, const Draft& draft) {
    for (const auto& [name, text] : draft.priors)
        parameter_of(settings, name, origin_of(draft.origins, "priors." + name));
    settings.priors.clear();
    for (const ParameterInfo& parameter : model_parameters(settings)) {
        const std::string name(parameter.name);
        if (settings.set.contains(name)) continue;
        const auto stated = draft.priors.find(name);
        if (stated != draft.priors.end())
            settings.priors[name] = prior_from(parameter, stated->second, draft.origins);
        else if (!std::isnan(parameter.held))
            settings.set[name] = parameter.held;
        else
            settings.priors[name] = prior_from(parameter, PriorText{}, draft.origins);
    }
}

void check_effects(const Settings& settings, const Origins& origins) {
    for (const std::string& name : settings.effects) {
        const ModelEffect& effect = *find_model_effect(name);
        if (effect.needs_rotation() && settings.rotation != "free")
            throw fault_at(origin_of(origins, "effects"), name, "needs particles that rotate",
                           "add --rotation free");
        if (!effect.goes_with(settings.law))
            throw fault_at(origin_of(origins, "effects"), name,
                           fmt::format("does not go with the law {}", settings.law),
                           fmt::format("it goes with {}", fmt::join(effect.contact->laws, " and ")));
        if (effect.needs_fragile() && settings.law == "linear-cohesive" && !settings.engine.fragile)
            throw fault_at(origin_of(origins, "effects"), name, "needs bonds that break",
                           "write fragile = true under [engine]");
    }
}

void check_parameters(const Settings& settings, const Origins& origins) {
    for (const auto& [name, value] : settings.set) {
        const Origin origin = origin_of(origins, "set." + name);
        const ParameterInfo parameter = parameter_of(settings, name, origin);
        if (!(value >= parameter.lower && value <= parameter.upper))
            throw fault_at(
                origin, fmt::format("{}", value),
                fmt::format("must lie in {} to {} {}", parameter.lower, parameter.upper, parameter.unit),
                "values are in SI, angles in rad");
    }
    for (const auto& [name, prior] : settings.priors)
        check_prior(parameter_of(settings, name, origin_of(origins, "priors." + name)), prior, origins);
    if (is_fitting(settings) && settings.priors.empty())
        throw fault_at(origin_of(origins, "set"), "", "leaves nothing to fit: every parameter is held fixed",
                       "fix fewer, or use loam simulate");
}

}  // namespace loam::experiments
