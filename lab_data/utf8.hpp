// UTF-8 as RFC 3629 defines it: what files must be written in, and messages are.
#pragma once

#include <cstddef>
#include <string_view>

namespace loam::lab_data {

/// Bytes of the character that `text` begins with, 1 to 4; 0 if it begins with none (or is empty).
std::size_t utf8_character_length(std::string_view text);

}  // namespace loam::lab_data
