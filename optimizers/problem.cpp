#include "optimizers/problem.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace loam::optimizers {

namespace {

/// Throws std::invalid_argument: "optimizers: <field> = <value>, but it must be <constraint>".
template <class Value>
[[noreturn]] void refuse(const std::string& field, Value value, const std::string& constraint) {
    std::ostringstream text;
    text << "optimizers: " << field << " = " << value << ", but it must be " << constraint;
    throw std::invalid_argument(text.str());
}

std::string indexed(const std::string& name, Eigen::Index i) {
    return name + '(' + std::to_string(i) + ')';
}

}  // namespace

void Bounds::validate() const {
    if (lower.size() == 0) refuse("Bounds::lower.size", 0, "at least 1");
    if (lower.size() != upper.size()) refuse("Bounds::upper.size", upper.size(), "the size of lower");
    for (Eigen::Index i = 0; i < lower.size(); ++i) {
        if (!std::isfinite(lower(i))) refuse(indexed("Bounds::lower", i), lower(i), "finite");
        if (!std::isfinite(upper(i))) refuse(indexed("Bounds::upper", i), upper(i), "finite");
        if (lower(i) > upper(i)) refuse(indexed("Bounds::lower", i), lower(i), "at most the upper bound");
    }
}

void validate_start(const Vector& start, const Bounds& bounds) {
    if (start.size() != bounds.size()) refuse("start.size", start.size(), "the number of bounds");
    for (Eigen::Index i = 0; i < start.size(); ++i) {
        if (!std::isfinite(start(i))) refuse(indexed("start", i), start(i), "finite");
    }
}

Bounds unit_cube(Eigen::Index d) {
    return {Vector::Zero(d), Vector::Ones(d)};
}

void Options::validate() const {
    if (max_evaluations < 1) refuse("Options::max_evaluations", max_evaluations, "at least 1");
    if (!(relative_tolerance > 0 && relative_tolerance < 1)) {
        refuse("Options::relative_tolerance", relative_tolerance, "between 0 and 1");
    }
    if (!(max_seconds >= 0)) refuse("Options::max_seconds", max_seconds, "at least 0 (0: no limit)");
}

}  // namespace loam::optimizers
