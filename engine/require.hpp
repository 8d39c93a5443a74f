// Checks of a caller's numbers.
#pragma once

#include <stdexcept>
#include <string>

namespace loam::engine {

/// Throws std::invalid_argument naming field, value and constraint where `ok` is false.
inline void require(bool ok, const char* field, double value, const char* constraint) {
    if (!ok)
        throw std::invalid_argument(std::string(field) + " = " + std::to_string(value) + ": must be " +
                                    constraint);
}

}  // namespace loam::engine
