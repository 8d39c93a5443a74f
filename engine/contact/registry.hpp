// The contact laws that the engine knows, with what each declares of its parameters.
// The command line, the configuration reader, the generated reference and the contract tests read this table.
// To add a law: one header engine/contact/<name>.hpp and one line of laws() in registry.cpp.
#pragma once

#include <span>
#include <string_view>

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

struct ParameterInfo {
    std::string_view name;    // the field's standard name
    std::string_view symbol;  // as a paper writes it
    std::string_view unit;    // SI; "1" for a ratio
    double lower;             // valid range, inclusive, SI
    double upper;
    PriorInfo prior;  // default prior when the parameter is fitted
    std::string_view meaning;
    std::string_view source;
};

struct LawInfo {
    std::string_view name;
    std::string_view meaning;
    std::string_view source;
    std::span<const ParameterInfo> parameters;
};

/// All laws, in a fixed order. The first is the default.
std::span<const LawInfo> laws();

/// The law of that name, or nullptr.
const LawInfo* find_law(std::string_view name);

}  // namespace loam::engine
