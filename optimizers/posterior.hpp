/// Draws from a density on a box, known up to a constant: several Markov chains whose proposals were learnt
/// beforehand.
///
/// The chains see the free variables as u on the unit cube and as z = Phi^-1(u), unbounded, Phi being the
/// standard normal distribution function; a direction that the density leaves open is a standard normal in z.
/// Five moves are mixed, each of which leaves the density as it is:
///  - differences of points of an archive, at the length that suits a normal density, in u and in z
///  (differential evolution
///    with a past archive; ter Braak & Vrugt 2008, Stat. Comput. 18, 435-446), for bent ridges;
///  - the whole difference, in u, that leads along straight ridges and from mode to mode (idem);
///  - independent draws from mixtures of t distributions fitted to the archive in u and in z (Tierney 1994,
///  Ann. Stat. 22,
///    1701-1728), which make most of the way where they fit, at one effective draw for two or three
///    evaluations.
/// A move in u that leaves the cube is refused, which costs nothing and is right, the density being zero
/// there; a move in z cannot leave it, and carries the Jacobian of the map. Reflection at a bound would be
/// wrong: reflected proposals that are correlated are not symmetric. The archive comes from particles
/// tempered from the uniform distribution (tempering.hpp); neither it nor the shares of the moves change
/// while draws are taken that are handed back.
#pragma once

#include "optimizers/problem.hpp"

namespace loam::optimizers {

struct PosteriorOptions {
    int chains = 8;            ///< >= 2
    int threads = 1;           ///< that evaluate the density at once, 0: as OpenMP says; the draws do not
                               ///< depend on it
    double wanted_ess = 4000;  ///< effective draws wanted of every variable, bulk and tails; >= 10 per chain
    double max_rhat = 1.01;    ///< in (1, 2); Vehtari et al. (2021) advise 1.01
    int max_evaluations =
        500000;              ///< of the density, warm-up included; >= 4000 and 800 a variable; never exceeded
    double max_seconds = 0;  ///< wall time; 0: no limit. A limit gives up repeatability
    int max_draws = 4000;    ///< rows of Posterior::draws, thinned evenly to at most so many; >= 1
    std::uint64_t seed = 1;

    /// For d variables. Throws std::invalid_argument naming field, value and constraint.
    void validate(Eigen::Index d) const;
};

struct Posterior {
    Matrix draws;           ///< [n x d], inside the bounds; sweep after sweep of all chains
    Vector log_density;     ///< [n] at the draws
    Vector mean, sd;        ///< [d] of all draws before thinning, like the diagnostics
    Vector rhat;            ///< [d] rank-normalised split R-hat
    Vector ess_bulk;        ///< [d] effective number of draws for the centre
    Vector ess_tail;        ///< [d] and for the 5 % and 95 % quantiles
    double acceptance = 0;  ///< of the moves of these draws
    int warmup_evaluations =
        0;            ///< part of summary.evaluations: all that was spent before the first of these draws
    Summary summary;  ///< converged: R-hat and effective sizes are as wanted, for every variable
};

/// Samples exp(log_density(x)) over `bounds`. The density is called without gradient; where it is not finite
/// (or not a number) it counts as zero; with several threads, from several at once. Variables with equal
/// bounds stay fixed, with R-hat 1 and as many effective draws as draws. Throws std::invalid_argument for
/// unsound bounds or options; std::runtime_error when hardly any of thousands of points spread over the box
/// has a density; whatever the density throws.
Posterior sample_posterior(const Objective& log_density, const Bounds& bounds,
                           const PosteriorOptions& options = {});

}  // namespace loam::optimizers
