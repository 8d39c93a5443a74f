/// The optimisers behind the table of optimizers/registry.hpp, one function each, all of one signature:
/// minimises `objective` over `bounds` from `start` [d] (moved into the box; global ones use it as one point
/// of many). Errors, for all: std::invalid_argument for unsound bounds, options or start; std::runtime_error
/// when the objective is finite at no point tried; whatever the objective throws.
#pragma once

#include "optimizers/problem.hpp"

namespace loam::optimizers {

Minimum minimise_lbfgs(const Objective&, const Bounds&, const Vector& start, const Options&);
Minimum minimise_slsqp(const Objective&, const Bounds&, const Vector& start, const Options&);
Minimum minimise_sbplx(const Objective&, const Bounds&, const Vector& start, const Options&);
Minimum minimise_direct_l(const Objective&, const Bounds&, const Vector& start, const Options&);
Minimum minimise_crs2(const Objective&, const Bounds&, const Vector& start, const Options&);
Minimum minimise_multistart_lbfgs(const Objective&, const Bounds&, const Vector& start, const Options&);

}  // namespace loam::optimizers
