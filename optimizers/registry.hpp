/// The table of optimisers: what each needs and is for.
/// To add one: its function in optimizers/<name>.cpp, declared in optimisers.hpp, and a line in registry.cpp.
#pragma once

#include <span>
#include <string_view>

#include "optimizers/problem.hpp"

namespace loam::optimizers {

enum class Scope { local, global };

struct Optimiser {
    std::string_view name;
    Scope scope;
    bool needs_gradient;  ///< the objective is asked for gradients, analytic ones
    std::string_view meaning;
    std::string_view source;
    Minimum (*minimise)(const Objective&, const Bounds&, const Vector& start, const Options&);
};

/// All of them, in a fixed order.
std::span<const Optimiser> optimisers();

/// The optimiser of that name; std::invalid_argument listing the names if there is none.
const Optimiser& find_optimiser(std::string_view name);

/// Minimises with the optimiser of that name; errors as in optimisers.hpp and find_optimiser().
Minimum minimise(std::string_view name, const Objective& objective, const Bounds& bounds, const Vector& start,
                 const Options& options = {});

}  // namespace loam::optimizers
