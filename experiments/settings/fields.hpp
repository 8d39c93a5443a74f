// The table of settings: where each lies in Settings, what it is called in a configuration file and on the
// command line, which values it may have and what it means. The configuration reader and writer, the checks,
// the comparison with a stored run and the command line's options all walk this table.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "experiments/settings/settings.hpp"

namespace loam::experiments {

/// Where a setting's value lies; the alternative says its type. An optional that is empty takes its value
/// from the data.
using Slot = std::variant<bool*, int*, std::uint64_t*, double*, std::string*, std::filesystem::path*,
                          std::optional<double>*, std::vector<std::string>*>;

/// The values a number may have. Bounds that are `open` are themselves excluded.
struct Limits {
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
    bool open_lower = false;
    bool open_upper = false;

    bool contain(double value) const;
    /// As the end of a sentence: "must be at least 1", "must be above 0 and below 1".
    std::string text() const;
};

/// Whether a run that is resumed must have the same value.
enum class Resuming { must_agree, may_differ };

struct Field {
    std::string_view section;  // table of the configuration file; empty: the top level
    std::string_view key;      // by this name in the file; the option is --key, with '-' for '_'
    Slot (*slot)(Settings&);
    std::string_view meaning;                              // one line, with its unit
    Limits limits = {};                                    // of numbers
    std::vector<std::string_view> (*choices)() = nullptr;  // of names; none: any text
    std::string_view option = "";  // what stands for the value in the help text; empty: not an option
    Resuming resuming = Resuming::must_agree;
    std::vector<std::string_view> (*verbs)() = nullptr;  // whose option it is; none: of all with settings

    /// Whether it is an option of that verb.
    bool is_option_of(std::string_view verb) const;
    /// "engine.damping", or the key alone at the top level.
    std::string path() const;
};

/// Every setting but the parameters of the law ([set] and [priors.NAME]), in the order they are written.
std::span<const Field> fields();

/// The field of that section and key, or nullptr.
const Field* find_field(std::string_view section, std::string_view key);

/// The sections of a configuration file, without the top level and without set and priors.
std::vector<std::string_view> sections();

}  // namespace loam::experiments
