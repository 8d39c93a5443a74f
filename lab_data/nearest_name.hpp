// "Did you mean": the valid name nearest to a mistyped one.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace loam::lab_data {

/// Least number of insertions, deletions, substitutions of a byte and swaps of neighbours that turn `a` into
/// `b` (optimal string alignment; Damerau 1964). Letter case counts.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The valid name nearest to `name`, or nothing when all are too far to be what was meant (more than a third
/// of the longer name's letters differ). Letter case and the difference between '-', ' ' and '_' are ignored;
/// among equals the first wins.
std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string_view> valid);

/// A remedy for an unknown name: "did you mean 'x'?" if one is near, else "use one of a, b, c".
std::string suggest_name(std::string_view name, std::span<const std::string_view> valid);

}  // namespace loam::lab_data
