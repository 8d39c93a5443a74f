#include "experiments/settings/reading.hpp"

#include <algorithm>

#include "experiments/output/file_descriptor.hpp"
#include "experiments/settings/conversion.hpp"
#include "experiments/settings/inputs.hpp"
#include "experiments/settings/parameters.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/settings/validation.hpp"

namespace loam::experiments {
namespace {

std::string option_name(std::string_view key) {
    std::string name = "--" + std::string(key);
    for (char& c : name)
        if (c == '_') c = '-';
    return name;
}

void read_fixed_parameter(Draft& draft, const std::string& text) {
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos || sign == 0)
        throw fault_at({.name = "--set"}, text, "must be NAME=VALUE", "write --set young_modulus=3e8");
    const std::string parameter = text.substr(0, sign);
    const Origin origin{.name = "--set " + parameter};
    const double value = number_of(std::string_view(text).substr(sign + 1), origin);
    const std::string path = "set." + parameter;
    const auto before = draft.origins.find(path);
    if (before != draft.origins.end() && before->second.file.empty())
        throw fault_at(origin, text.substr(sign + 1), "is there twice", "fix a parameter once");
    draft.settings.set[parameter] = value;
    draft.origins[path] = origin;
}

/// Of one sample's first design. Ten for each parameter will do for an emulator of a smooth answer (Loeppky,
/// Sacks & Welch 2009); packings scatter, and a third of the runs lie far from where they are needed.
int usual_runs(const Settings& settings) {
    constexpr int most_of_a_diagnosis = 80;  // which is several calibrations
    const int runs = 20 * (static_cast<int>(settings.priors.size()) + 1);
    return settings.verb == "diagnose" ? std::min(runs, most_of_a_diagnosis) : runs;
}

/// The effect `rotation` frees what a setting has blocked, if that was stated.
void demand_free_rotation(const Settings& settings, const Origins& origins) {
    const bool frees = std::ranges::find(settings.effects, "rotation") != settings.effects.end();
    if (frees && settings.rotation == "blocked" && origins.contains("rotation"))
        throw fault_at(origin_of(origins, "rotation"), "blocked", "contradicts the effect rotation",
                       "leave one of the two out");
}

}  // namespace

void read_override(Draft& draft, const Override& given) {
    if (given.name == "set") return read_fixed_parameter(draft, given.text);
    const Field& field = *find_field("", given.name);
    const bool positional = given.name == "sample" || given.name == "benchmark" || given.name == "verb";
    const Origin origin{.name = positional ? given.name : option_name(given.name)};
    assign_text(draft.settings, field, given.text, origin);
    draft.origins[given.name] = origin;
}

Settings complete(const Draft& draft) {
    Settings settings = draft.settings;
    demand_free_rotation(settings, draft.origins);
    free_rotation_where_it_is_an_effect(settings);
    // An unknown law has no priors to complete; validate() says so.
    if (engine::find_law(settings.law)) complete_priors(settings, draft);
    if (is_fitting(settings) && settings.verb != "bulk" && !draft.origins.contains("runs"))
        settings.runs = usual_runs(settings);
    validate(settings, draft.origins);
    return settings;
}

Settings read_configuration(const std::filesystem::path& file) {
    Draft draft;
    read_toml(draft, read_whole_file(file), file);
    return complete(draft);
}

Settings read_settings(std::string_view verb, const std::filesystem::path& configuration,
                       const std::vector<Override>& overrides) {
    Draft draft;
    demand_utf8(configuration, {.name = "--config"});
    if (!configuration.empty()) read_toml(draft, read_whole_file(configuration), configuration);
    read_override(draft, {"verb", std::string(verb)});
    for (const Override& given : overrides) read_override(draft, given);
    complete(draft);  // mistakes of the settings show before those of the data
    resolve_inputs(draft);
    Settings settings = complete(draft);
    spare_configuration(configuration, settings);
    return settings;
}

}  // namespace loam::experiments
