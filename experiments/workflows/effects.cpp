#include "experiments/workflows/effects.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/contact/registry.hpp"
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

nlohmann::json as_json(const LawInfo& law) {
    nlohmann::json parameters = nlohmann::json::array();
    for (const ParameterInfo& parameter : law.parameters)
        parameters.push_back({{"name", parameter.name},
                              {"symbol", parameter.symbol},
                              {"unit", parameter.unit},
                              {"lower", parameter.lower},
                              {"upper", parameter.upper},
                              {"prior", as_json(parameter.prior)},
                              {"meaning", parameter.meaning},
                              {"source", parameter.source}});
    return {{"name", law.name}, {"meaning", law.meaning}, {"source", law.source}, {"parameters", parameters}};
}

void print_law(const LawInfo& law) {
    fmt::print("law {}: {}\n  source: {}\n", law.name, law.meaning, law.source);
    for (const ParameterInfo& parameter : law.parameters) {
        fmt::print("\n  {} ({}), {}: {}\n", parameter.name, parameter.symbol, parameter.unit,
                   parameter.meaning);
        fmt::print("    range   {:.4g} to {:.4g}\n", parameter.lower, parameter.upper);
        fmt::print("    prior   {}\n", prior_text(parameter.prior));
        fmt::print("    source  {}\n", parameter.source);
    }
}

}  // namespace

int run_effects(const PlainArguments& arguments) {
    if (arguments.json) {
        nlohmann::json laws = nlohmann::json::array();
        for (const LawInfo& law : engine::laws()) laws.push_back(as_json(law));
        fmt::print("{}\n", nlohmann::json{{"laws", laws}, {"effects", nlohmann::json::array()}}.dump(2));
        return 0;
    }
    for (const LawInfo& law : engine::laws()) print_law(law);
    fmt::print("\nrotation of the particles: blocked or free, in every law (--rotation)\n");
    fmt::print("effects on top of a law: none in this version\n");
    return 0;
}

}  // namespace loam::experiments
