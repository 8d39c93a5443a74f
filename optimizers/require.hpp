// The check that every struct of options makes of its fields.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace loam::optimizers {

/// Throws std::invalid_argument naming the struct, the field, its value and the constraint unless that holds.
template <class Value>
void require(bool holds, const char* options, const char* field, Value value, const std::string& constraint) {
    if (holds) return;
    std::ostringstream text;
    text << "optimizers: " << options << "::" << field << " = " << value << ", but it must be " << constraint;
    throw std::invalid_argument(text.str());
}

}  // namespace loam::optimizers
