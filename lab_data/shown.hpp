// Text from the user's files as it may stand in a message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace loam::lab_data {

/// The text as it can be shown on a terminal and written as JSON: cut to `longest` bytes or so, control
/// characters and what is no UTF-8 escaped.
std::string shown(std::string_view value, std::size_t longest = 60);

}  // namespace loam::lab_data
