#include "engine/cloud.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace loam::engine {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

// Of a gas. A cloud as dense as random addition can fill it (0.62) is as uniform as a liquid and is compacted
// to another fabric: at one friction (0.31 rad, rotation blocked) to a void ratio of 0.81 instead of 0.89,
// and at one void ratio to a third fewer contacts. YADE compacts the denser cloud to 0.80, and a gas of its
// own to 0.90.
constexpr double cloud_porosity = 0.76;
// In a box the dense cloud it is: YADE's direct shear curves of lab_data/sets/twin_blocked ask for its fabric.
// From a cloud of 0.70 the shear stress rises a quarter too fast at first, and half as much is compacted.
constexpr double boxed_cloud_porosity = 0.62;

/// splitmix64 (Steele, Lea & Flood 2014): the same numbers on every platform.
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    double uniform() {
        state_ += 0x9e3779b97f4a7c15ull;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
    }

  private:
    std::uint64_t state_;
};

/// The sizes, the largest first. They are stratified: every packing has the same grading up to the jitter
/// inside the strata.
Eigen::VectorXd draw_radii(const PackingOptions& options, Random& random) {
    const Index n = static_cast<Index>(options.particles);
    Eigen::VectorXd radii(n);
    for (Index p = 0; p < n; ++p) {
        const double u = (static_cast<double>(n - 1 - p) + random.uniform()) / static_cast<double>(n);
        radii[p] = options.mean_radius * (1 + options.size_spread * (2 * u - 1));
    }
    return radii;
}

double solid_volume(const Eigen::VectorXd& radii) {
    return 4.0 / 3.0 * std::numbers::pi * radii.array().cube().sum();
}

/// Random sequential addition on a grid of bins as wide as the largest sphere, in a box that is periodic or
/// walled.
class Addition {
  public:
    Addition(const Eigen::VectorXd& radii, const Vector3d& sides, bool walled)
        : radii_(radii), sides_(sides), walled_(walled), centres_(3, radii.size()) {
        for (int k = 0; k < 3; ++k)
            bins_[k] = std::max(1, static_cast<int>(sides[k] / (2 * radii.maxCoeff())));
        members_.resize(static_cast<std::size_t>(bins_[0] * bins_[1] * bins_[2]));
    }

    /// Empty where a particle finds no room.
    std::optional<Eigen::Matrix3Xd> run(Random& random) {
        for (Index p = 0; p < radii_.size(); ++p) {
            Vector3d x;
            int tries = 0;
            do {
                x = draw(random, radii_[p]);
                if (++tries > 200000) return std::nullopt;
            } while (!is_free(x, radii_[p]));
            centres_.col(p) = x;
            members_[index(bin(x, 0), bin(x, 1), bin(x, 2))].push_back(p);
        }
        return centres_;
    }

  private:
    Vector3d draw(Random& random, double r) const {
        Vector3d x;
        for (int k = 0; k < 3; ++k)
            x[k] = walled_ ? r + (sides_[k] - 2 * r) * random.uniform() : sides_[k] * random.uniform();
        return x;
    }
    int bin(const Vector3d& x, int k) const {
        return std::min(bins_[k] - 1, static_cast<int>(x[k] / sides_[k] * bins_[k]));
    }
    std::size_t index(int a, int b, int c) const {
        const auto wrapped = [&](int i, int k) { return (i + bins_[k]) % bins_[k]; };
        return static_cast<std::size_t>((wrapped(a, 0) * bins_[1] + wrapped(b, 1)) * bins_[2] +
                                        wrapped(c, 2));
    }
    bool is_free(const Vector3d& x, double r) const {
        for (int a = -1; a <= 1; ++a)
            for (int b = -1; b <= 1; ++b)
                for (int c = -1; c <= 1; ++c)
                    for (const Index q : members_[index(bin(x, 0) + a, bin(x, 1) + b, bin(x, 2) + c)])
                        if (distance(x, q) < r + radii_[q]) return false;
        return true;
    }
    double distance(const Vector3d& x, Index q) const {
        Vector3d d = centres_.col(q) - x;
        for (int k = 0; k < 3 && !walled_; ++k) d[k] -= sides_[k] * std::round(d[k] / sides_[k]);
        return d.norm();
    }

    const Eigen::VectorXd& radii_;
    Vector3d sides_;
    bool walled_;
    Eigen::Matrix3Xd centres_;
    int bins_[3];
    std::vector<std::vector<Index>> members_;
};

/// The first that `make` gives, at a porosity that rises from where most gradings find room.
template <typename Make>
auto in_room(double porosity, const Make& make) {
    for (; porosity < 0.97; porosity = 1 - 0.9 * (1 - porosity))
        if (auto made = make(porosity)) return std::move(*made);
    throw std::runtime_error("no room for the particles of the packing; a smaller size_spread helps");
}

}  // namespace

Packing make_cloud(const PackingOptions& options) {
    return in_room(cloud_porosity, [&](double porosity) -> std::optional<Packing> {
        Random random(options.seed);
        Packing cloud;
        cloud.radii = draw_radii(options, random);
        const double side = std::cbrt(solid_volume(cloud.radii) / (1 - porosity));
        cloud.cell = Eigen::Matrix3d::Identity() * side;
        auto centres = Addition(cloud.radii, Vector3d::Constant(side), false).run(random);
        if (!centres) return std::nullopt;
        cloud.centres = std::move(*centres);
        return cloud;
    });
}

BoxedCloud make_boxed_cloud(const PackingOptions& options, const Vector3d& proportions, double margin) {
    return in_room(boxed_cloud_porosity, [&](double porosity) -> std::optional<BoxedCloud> {
        Random random(options.seed);
        BoxedCloud cloud;
        Packing& packing = cloud.packing;
        packing.radii = draw_radii(options, random);
        const double volume = solid_volume(packing.radii) / (1 - porosity);
        const Vector3d sides = proportions * std::cbrt(volume / proportions.prod());
        if (sides.minCoeff() < 2 * packing.radii.maxCoeff()) return std::nullopt;
        cloud.box.low = Vector3d::Constant(margin * sides.maxCoeff());
        cloud.box.high = cloud.box.low + sides;
        packing.cell = (cloud.box.low + cloud.box.high).asDiagonal();
        const auto centres = Addition(packing.radii, sides, true).run(random);
        if (!centres) return std::nullopt;
        packing.centres = centres->colwise() + cloud.box.low;
        return cloud;
    });
}

}  // namespace loam::engine
