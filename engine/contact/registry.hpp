// The contact laws and effects that the engine knows, with what each declares of its parameters, its history
// and its partners. The command line, the configuration reader, the generated reference and the contract
// tests read these tables. To add a law or an effect: one header engine/contact/<name>.hpp, and one line of
// the table in registry.cpp or registry_effects.cpp.
#pragma once

#include <limits>
#include <span>
#include <string_view>

#include "engine/contact/contact_law.hpp"

namespace loam::engine {

/// How a prior is spread. `lognormal`: log10 of the value is normal, and mean, sd are those of the log10.
/// `loguniform`: log10 of the value is uniform over the bounds. Every prior is truncated to the bounds.
enum class PriorKind { normal, lognormal, uniform, loguniform };

struct PriorInfo {
    PriorKind kind;
    double mean = 0;   // of the value, or of its log10 for lognormal; unused for (log)uniform
    double sd = 0;     // likewise
    double lower = 0;  // truncation in physical (SI) units
    double upper = 0;
};

/// `ParameterInfo::held` of a parameter that is fitted unless the configuration holds it.
inline constexpr double fitted = std::numeric_limits<double>::quiet_NaN();

struct ParameterInfo {
    std::string_view name;    // the field's standard name
    std::string_view symbol;  // as a paper writes it
    std::string_view unit;    // SI; "1" for a ratio
    double lower;             // valid range, inclusive, SI
    double upper;
    PriorInfo prior;  // default prior when the parameter is fitted
    std::string_view meaning;
    std::string_view source;
    double held = fitted;  // value unless a prior is stated
};

struct LawInfo {
    std::string_view name;
    std::string_view meaning;
    std::string_view source;
    std::span<const ParameterInfo> parameters;
    /// The law with these values (SI), in the order of `parameters`.
    ContactLaw (*make)(std::span<const double> values);
};

struct EffectInfo {
    std::string_view name;
    std::string_view meaning;
    std::string_view source;
    std::span<const ParameterInfo> parameters;  // the first is the strength, 0 for none
    int history;          // doubles that it keeps for each contact; those but rolling_resistance share theirs
    bool needs_rotation;  // else rotations may be blocked
    bool needs_fragile;   // the bonds of linear-cohesive must be fragile
    std::span<const std::string_view> laws;  // that it goes with; empty: every one
    /// Adds the effect with these values (SI), in the order of `parameters`.
    void (*apply)(ContactLaw& law, std::span<const double> values);

    /// Whether it goes with the law of that name.
    bool goes_with(std::string_view law) const;
};

/// All laws, in a fixed order. The first is the default.
std::span<const LawInfo> laws();

/// The law of that name, or nullptr.
const LawInfo* find_law(std::string_view name);

/// All effects, in a fixed order.
std::span<const EffectInfo> effects();

/// The effect of that name, or nullptr.
const EffectInfo* find_effect(std::string_view name);

}  // namespace loam::engine
