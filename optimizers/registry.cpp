#include "optimizers/registry.hpp"

#include <array>
#include <stdexcept>
#include <string>

#include "optimizers/optimisers.hpp"

namespace loam::optimizers {

namespace {

constexpr std::array table{
    Optimiser{"lbfgs", Scope::local, true, "limited-memory BFGS with bounds; smooth functions",
              "Liu & Nocedal 1989, Math. Program. 45, 503-528; code of Luksan in NLopt", minimise_lbfgs},
    Optimiser{"slsqp", Scope::local, true,
              "sequential quadratic programming; smooth functions of few variables",
              "Kraft 1994, ACM Trans. Math. Softw. 20, 262-281; in NLopt", minimise_slsqp},
    Optimiser{"sbplx", Scope::local, false, "simplices in subspaces; no gradient, rough or noisy functions",
              "Rowan 1990, thesis, University of Texas at Austin; as re-implemented in NLopt",
              minimise_sbplx},
    Optimiser{"direct-l", Scope::global, false,
              "dividing rectangles, locally biased; deterministic, few variables",
              "Gablonsky & Kelley 2001, J. Glob. Optim. 21, 27-37; in NLopt", minimise_direct_l},
    Optimiser{"crs2", Scope::global, false, "controlled random search with local mutation",
              "Kaelo & Ali 2006, J. Optim. Theory Appl. 130, 253-264; in NLopt", minimise_crs2},
    Optimiser{"multistart-lbfgs", Scope::global, true,
              "L-BFGS from many starts until no minimum is likely unseen",
              "Boender & Rinnooy Kan 1987, Math. Program. 37, 59-80", minimise_multistart_lbfgs},
};

}  // namespace

std::span<const Optimiser> optimisers() {
    return table;
}

const Optimiser& find_optimiser(std::string_view name) {
    std::string names;
    for (const Optimiser& entry : table) {
        if (entry.name == name) return entry;
        names += (names.empty() ? "" : ", ") + std::string(entry.name);
    }
    throw std::invalid_argument("optimizers: there is no optimiser \"" + std::string(name) +
                                "\"; there are " + names);
}

Minimum minimise(std::string_view name, const Objective& objective, const Bounds& bounds, const Vector& start,
                 const Options& options) {
    return find_optimiser(name).minimise(objective, bounds, start, options);
}

}  // namespace loam::optimizers
