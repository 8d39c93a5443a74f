#include "experiments/settings/validation.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "experiments/settings/conversion.hpp"
#include "experiments/settings/fields.hpp"
#include "experiments/settings/parameters.hpp"
#include "lab_data/nearest_name.hpp"

namespace loam::experiments {
namespace {

/// Checks the value that a slot points to against the field's limits or choices.
struct CheckSlot {
    const Field& field;
    const Origin& origin;

    void operator()(const bool*) const {}
    void operator()(const std::filesystem::path*) const {}
    void operator()(const int* slot) const { number(*slot); }
    void operator()(const std::uint64_t* slot) const { number(static_cast<double>(*slot)); }
    void operator()(const double* slot) const { number(*slot); }
    void operator()(const std::optional<double>* slot) const {
        if (*slot) number(**slot);
    }
    void operator()(const std::string* slot) const {
        const bool unstated =
            slot->empty() && field.key == "verb";  // as in a configuration for several verbs
        if (!unstated) name(*slot);
    }
    void operator()(const std::vector<std::string>* slot) const {
        for (const std::string& item : *slot) {
            name(item);
            if (std::ranges::count(*slot, item) > 1)
                throw fault_at(origin, item, "is there twice", "name it once");
        }
    }

    void number(double value) const {
        if (!field.limits.contain(value))
            throw fault_at(origin, fmt::format("{}", value), field.limits.text(), "");
    }
    void name(const std::string& value) const {
        if (!field.choices) return;
        const auto valid = field.choices();
        if (std::ranges::find(valid, value) == valid.end())
            throw fault_at(origin, value, "is not known here", lab_data::suggest_name(value, valid));
    }
};

bool is_count(const std::string& text) {
    return !text.empty() && text.size() < 10 && text.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

Origin origin_of(const Origins& origins, std::string_view path) {
    const auto found = origins.find(path);
    return found == origins.end() ? Origin{.name = std::string(path)} : found->second;
}

void validate(const Settings& settings, const Origins& origins) {
    Settings copy = settings;  // slots point into settings that can be changed
    for (const Field& field : fields()) {
        const Origin origin = origin_of(origins, field.path());
        std::visit([&](auto* slot) { CheckSlot{field, origin}(slot); }, field.slot(copy));
    }
    check_effects(settings, origins);
    check_parameters(settings, origins);
    if (const std::string& n = settings.confirm; n != "all" && n != "none" && !is_count(n))
        throw fault_at(origin_of(origins, "confirm"), n, "must be all, none or a number of samples", "");
    const int fewest = fewest_training_runs(static_cast<int>(settings.priors.size()));
    if (is_fitting(settings) && settings.runs < fewest)
        throw fault_at(
            origin_of(origins, "runs"), fmt::format("{}", settings.runs),
            fmt::format("must be at least {} to fit {} parameters", fewest, settings.priors.size()),
            "make more runs, or hold more parameters fixed with --set");
}

}  // namespace loam::experiments
