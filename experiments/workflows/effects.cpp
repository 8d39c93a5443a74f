#include "experiments/workflows/effects.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "experiments/effects/model_effects.hpp"
#include "experiments/settings/parameters.hpp"

namespace loam::experiments {
namespace {

using engine::LawInfo;
using engine::ParameterInfo;
using engine::PriorInfo;

std::string prior_text(const PriorInfo& prior) {
    const std::string bounds = fmt::format("{:.4g} to {:.4g}", prior.lower, prior.upper);
    const std::string kind(to_string(prior.kind));
    if (!has_mean(prior.kind)) return fmt::format("{} over {}", kind, bounds);
    return fmt::format("{}, mean {:.4g}, sd {:.4g}{}, within {}", kind, prior.mean, prior.sd,
                       is_logarithmic(prior.kind) ? " (of log10 of the value)" : "", bounds);
}

nlohmann::json as_json(const PriorInfo& prior) {
    nlohmann::json document{{"kind", to_string(prior.kind)}, {"lower", prior.lower}, {"upper", prior.upper}};
    if (has_mean(prior.kind)) {
        document["mean"] = prior.mean;
        document["sd"] = prior.sd;
    }
    return document;
}

nlohmann::json as_json(std::span<const ParameterInfo> parameters) {
    nlohmann::json out = nlohmann::json::array();
    for (const ParameterInfo& parameter : parameters) {
        out.push_back({{"name", parameter.name},
                       {"symbol", parameter.symbol},
                       {"unit", parameter.unit},
                       {"lower", parameter.lower},
                       {"upper", parameter.upper},
                       {"prior", as_json(parameter.prior)},
                       {"meaning", parameter.meaning},
                       {"source", parameter.source}});
        if (!std::isnan(parameter.held)) out.back()["held"] = parameter.held;
    }
    return out;
}

nlohmann::json as_json(const LawInfo& law) {
    return {{"name", law.name},
            {"meaning", law.meaning},
            {"source", law.source},
            {"parameters", as_json(law.parameters)}};
}

std::string_view of(const ModelEffect& effect) {
    switch (effect.origin) {
        case EffectOrigin::contact:
            return "contact";
        case EffectOrigin::rotation:
            return "rotation";
        case EffectOrigin::apparatus:
            return "apparatus";
        case EffectOrigin::specimen:
            return "specimen";
    }
    return "";
}

/// The laws that an effect goes with.
std::vector<std::string_view> names_of_laws(const ModelEffect& effect) {
    std::vector<std::string_view> names;
    for (const LawInfo& law : engine::laws())
        if (effect.goes_with(law.name)) names.push_back(law.name);
    return names;
}

nlohmann::json as_json(const ModelEffect& effect) {
    return {{"name", effect.name},
            {"meaning", effect.meaning},
            {"source", effect.source},
            {"of", of(effect)},
            {"needs_rotation", effect.needs_rotation()},
            {"laws", names_of_laws(effect)},
            {"parameters", as_json(effect.parameters)}};
}

void print_parameters(std::span<const ParameterInfo> parameters) {
    for (const ParameterInfo& parameter : parameters) {
        fmt::print("\n  {} ({}), {}: {}\n", parameter.name, parameter.symbol, parameter.unit,
                   parameter.meaning);
        fmt::print("    range   {:.4g} to {:.4g}\n", parameter.lower, parameter.upper);
        if (std::isnan(parameter.held))
            fmt::print("    prior   {}\n", prior_text(parameter.prior));
        else
            fmt::print("    held at {:.4g}, unless a prior is stated; then {}\n", parameter.held,
                       prior_text(parameter.prior));
        fmt::print("    source  {}\n", parameter.source);
    }
}

void print_model() {
    for (const LawInfo& law : engine::laws()) {
        fmt::print("law {}: {}\n  source: {}\n", law.name, law.meaning, law.source);
        print_parameters(law.parameters);
        fmt::print("\n");
    }
    fmt::print("rotation of the particles: blocked or free, in every law (--rotation)\n");
    for (const ModelEffect& effect : model_effects()) {
        const auto laws = names_of_laws(effect);
        fmt::print(
            "\neffect {}, of the {}, on {}: {}{}\n  source: {}\n", effect.name, of(effect),
            laws.size() == engine::laws().size() ? "every law" : fmt::format("{}", fmt::join(laws, ", ")),
            effect.meaning, effect.needs_rotation() ? " (needs --rotation free)" : "", effect.source);
        print_parameters(effect.parameters);
    }
}

}  // namespace

int run_effects(const PlainArguments& arguments) {
    if (arguments.json) {
        nlohmann::json laws = nlohmann::json::array();
        for (const LawInfo& law : engine::laws()) laws.push_back(as_json(law));
        nlohmann::json effects = nlohmann::json::array();
        for (const ModelEffect& effect : model_effects()) effects.push_back(as_json(effect));
        fmt::print("{}\n", nlohmann::json{{"laws", laws}, {"effects", effects}}.dump(2));
        return 0;
    }
    print_model();
    return 0;
}

}  // namespace loam::experiments
