/// The moves of the posterior sampler. Inside this library only; posterior.hpp says what they are.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "optimizers/problem.hpp"
#include "optimizers/random.hpp"
#include "optimizers/scaled_box.hpp"
#include "optimizers/t_mixture.hpp"

namespace loam::optimizers {

/// The state of a chain: one point in three coordinates, and its densities.
struct ChainState {
    Vector x;                ///< [d] of the box
    Vector u;                ///< [k] free variables on the open unit cube
    Vector z;                ///< [k] unbounded, u = Phi(z)
    double log_density = 0;  ///< the caller's, at x
    /// Of the kernel's independent proposals at u and z, once they were asked for.
    std::optional<double> log_proposal_u, log_proposal_z;
};

/// The caller's density as one of the free variables.
class CubeTarget {
  public:
    /// `threads`: that evaluate at once, where several states are to be; 0: as OpenMP says.
    CubeTarget(const Objective& log_density, const Bounds& bounds, int threads);

    /// Number of free variables, k.
    Eigen::Index size() const { return box_.size(); }
    int evaluations() const { return evaluations_; }
    /// Places the state at u or at z; false where that is not inside the cube.
    static bool place_u(const Vector& u, ChainState& state);
    static bool place_z(const Vector& z, ChainState& state);
    /// Fills in the densities at where the states are placed. Throws what the density threw first.
    void evaluate(std::span<ChainState* const> states);

  private:
    const Objective& log_density_;
    ScaledBox box_;
    int threads_, evaluations_ = 0;
};

enum Move : std::size_t { difference_u, difference_z, jump_u, independent_u, independent_z };
constexpr std::size_t move_count = 5;
using Shares = std::array<double, move_count>;

/// What each kind of move has achieved.
struct Tally {
    Shares jumped{};  ///< sum of squared jumps, in units of the archive's spread
    Shares cost{};    ///< evaluations
    double steps = 0, accepted = 0;

    double total_jumped() const;
    /// In proportion to the squared jump an evaluation is expected to bring, the classic measure of a move's
    /// worth (Pasarica & Gelman 2010, Stat. Sinica 20, 343-364), but never below 3 %: what seldom succeeds
    /// may be all that does somewhere.
    Shares shares() const;
};

/// Metropolis-Hastings moves learnt from an archive of states and fixed once made. Each leaves density^temper
/// as it is.
class Kernel {
  public:
    /// archive: m >= 2 states, not all the same. `components`: most in a mixture of the independent
    /// proposals.
    Kernel(CubeTarget& target, const std::vector<ChainState>& archive, int components, const Shares& shares,
           Random& random);

    /// One move of each of the states, of one evaluation at the most, told to the tally. A state that was
    /// last moved by another kernel must have its proposals' densities cleared. Which of them were accepted.
    std::vector<bool> sweep(std::vector<ChainState>& states, double temper, Random& random,
                            Tally& tally) const;

  private:
    struct Proposal {
        Move move = difference_u;
        double threshold = 0;
        ChainState state;
        bool possible = false;  // inside the cube
    };

    Proposal propose(const ChainState& state, Random& random) const;
    bool place(const ChainState& state, Proposal& proposal, Random& random) const;
    bool accept(ChainState& state, Proposal& proposal, double temper, Tally& tally) const;
    double log_ratio(Move move, ChainState& state, ChainState& proposed, double temper) const;
    Vector difference(const Matrix& archive, Random& random) const;

    CubeTarget& target_;
    Shares shares_;
    Matrix u_, z_;   ///< [k x m] the archive
    Matrix root_z_;  ///< lower Cholesky factor of the covariance of z_
    TMixture mixture_u_, mixture_z_;
};

}  // namespace loam::optimizers
