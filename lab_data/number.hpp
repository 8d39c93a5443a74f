// Numbers as people write them in files: read the same under every locale, and refused with advice.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace loam::lab_data {

/// The text without white space at its ends.
std::string_view trimmed(std::string_view text);

/// A finite decimal number with a decimal point, optionally signed and with an exponent; white space around
/// it is ignored. Nothing for anything else: decimal commas, hexadecimal, inf, nan, units, more than a double
/// can hold.
std::optional<double> parse_number(std::string_view text);

/// What to write instead of a text that parse_number() refuses.
std::string number_remedy(std::string_view text);

}  // namespace loam::lab_data
