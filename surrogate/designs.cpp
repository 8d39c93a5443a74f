#include "surrogate/designs.hpp"

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "optimizers/random.hpp"

namespace loam::surrogate {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using optimizers::Random;

void require(bool holds, const std::string& message) {
    if (!holds) throw std::invalid_argument(message);
}

Eigen::MatrixXd random_latin_cells(Index n, Index d, Random& random) {
    Eigen::MatrixXd cells(n, d);
    for (Index c = 0; c < d; ++c) {
        for (Index i = 0; i < n; ++i) cells(i, c) = static_cast<double>(i);
        for (Index i = n - 1; i > 0; --i) std::swap(cells(i, c), cells(random.index(i + 1), c));
    }
    return cells;
}

// The phi_p criterion of a Latin hypercube, kept up to date under swaps within a column.
class SpreadCriterion {
  public:
    explicit SpreadCriterion(Eigen::MatrixXd cells) : cells_(std::move(cells)) {
        // Distances are counted in typical nearest-neighbour distances, n^(1 - 1/d) cells, which keeps powers
        // tame.
        const double n = static_cast<double>(cells_.rows());
        unit_ = std::pow(n, 2 / static_cast<double>(cells_.cols()) - 2);
        crowding_.resize(cells_.rows());
        for (Index i = 0; i < cells_.rows(); ++i) {
            ArrayXd squared = squared_distances(i);
            crowding_(i) = repulsion(squared, i, i).sum();
        }
    }

    // Swaps entries i and j of column c if the points are then better spread.
    void try_swap(Index i, Index j, Index c) {
        const ArrayXd old_i = squared_distances(i), old_j = squared_distances(j);
        const ArrayXd to_i = (cells_.col(c).array() - cells_(i, c)).square() * unit_;
        const ArrayXd to_j = (cells_.col(c).array() - cells_(j, c)).square() * unit_;
        const ArrayXd shift = to_j - to_i;
        // The distance between i and j themselves does not change by the swap.
        const ArrayXd change_i = repulsion(old_i + shift, i, j) - repulsion(old_i, i, j);
        const ArrayXd change_j = repulsion(old_j - shift, i, j) - repulsion(old_j, i, j);
        const double total_i = change_i.sum(), total_j = change_j.sum();
        if (!(total_i + total_j < 0)) return;
        std::swap(cells_(i, c), cells_(j, c));
        crowding_ += change_i + change_j;
        crowding_(i) += total_i;
        crowding_(j) += total_j;
    }

    double crowding(Index i) const { return crowding_(i); }
    const Eigen::MatrixXd& cells() const { return cells_; }

  private:
    ArrayXd squared_distances(Index i) const {
        ArrayXd squared = ArrayXd::Zero(cells_.rows());
        for (Index c = 0; c < cells_.cols(); ++c) squared += (cells_.col(c).array() - cells_(i, c)).square();
        return squared * unit_;
    }

    static ArrayXd repulsion(const ArrayXd& squared, Index i, Index j) {
        ArrayXd power = squared.inverse();
        power(i) = power(j) = 0;
        const ArrayXd square = power.square();
        return square.square().square() * square;  // distance^-20
    }

    Eigen::MatrixXd cells_;
    ArrayXd crowding_;
    double unit_ = 1;
};

std::uint32_t reverse_bits(std::uint32_t v) {
    v = ((v >> 1) & 0x55555555U) | ((v & 0x55555555U) << 1);
    v = ((v >> 2) & 0x33333333U) | ((v & 0x33333333U) << 2);
    v = ((v >> 4) & 0x0F0F0F0FU) | ((v & 0x0F0F0F0FU) << 4);
    v = ((v >> 8) & 0x00FF00FFU) | ((v & 0x00FF00FFU) << 8);
    return (v >> 16) | (v << 16);
}

// A nested uniform scramble: each bit is flipped by a hash of the higher bits (Laine & Karras 2011; Burley
// 2020, with the constants of Vegdahl 2021, which mix better).
std::uint32_t owen_scramble(std::uint32_t v, std::uint32_t seed) {
    v = reverse_bits(v);
    v ^= v * 0x3D20ADEAU;
    v += seed;
    v *= (seed >> 16) | 1U;
    v ^= v * 0x05526C56U;
    v ^= v * 0x53A22864U;
    return reverse_bits(v);
}

}  // namespace

Eigen::MatrixXd maximin_latin_hypercube(Index n, Index d, std::uint64_t seed) {
    require(n >= 1 && d >= 1, "a Latin hypercube needs n >= 1 points and d >= 1 dimensions, got n = " +
                                  std::to_string(n) + ", d = " + std::to_string(d));
    Random random(seed);
    SpreadCriterion design(random_latin_cells(n, d, random));
    const Index swaps = n < 3 || d < 2 ? 0 : std::min<Index>(100 * n * d, 20'000'000 / n);
    for (Index trial = 0; trial < swaps; ++trial) {
        // The most crowded of three is moved: that is where most is to be gained.
        Index i = random.index(n);
        for (int rival = 0; rival < 2; ++rival) {
            const Index other = random.index(n);
            if (design.crowding(other) > design.crowding(i)) i = other;
        }
        const Index j = (i + 1 + random.index(n - 1)) % n;
        design.try_swap(i, j, random.index(d));
    }
    return (design.cells().array() + 0.5) / static_cast<double>(n);
}

Eigen::MatrixXd sobol_sequence(Index n, Index d, const SobolOptions& options) {
    require(n >= 1 && d >= 1 && d <= 1000,
            "a Sobol sequence needs n >= 1 points and 1 <= d <= 1000 dimensions, got n = " +
                std::to_string(n) + ", d = " + std::to_string(d));
    require(n <= (Index{1} << 31) && options.skip <= (1U << 31) - static_cast<std::uint32_t>(n),
            "a Sobol sequence ends at 2^31 points, got skip = " + std::to_string(options.skip) +
                ", n = " + std::to_string(n));
    boost::random::sobol_engine<std::uint32_t, 32> engine(static_cast<std::size_t>(d));
    // Boost's sequence leaves out point 0, the corner, without which the strata are not balanced.
    if (options.skip > 0) engine.seed(options.skip - 1);
    std::vector<std::uint32_t> seeds(static_cast<std::size_t>(d));
    for (std::size_t c = 0; c < seeds.size(); ++c)
        seeds[c] = static_cast<std::uint32_t>(optimizers::hash(optimizers::hash(options.seed) + c) >> 32);

    Eigen::MatrixXd points(n, d);
    for (Index i = 0; i < n; ++i) {
        for (Index c = 0; c < d; ++c) {
            const std::uint32_t bits = options.skip + static_cast<std::uint32_t>(i) == 0 ? 0 : engine();
            points(i, c) = options.scramble
                               ? (owen_scramble(bits, seeds[static_cast<std::size_t>(c)]) + 0.5) * 0x1p-32
                               : bits * 0x1p-32;
        }
    }
    return points;
}

}  // namespace loam::surrogate
