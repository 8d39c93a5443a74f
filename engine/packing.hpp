// Packings: spheres in a periodic cell, and the generator that makes them to a grading, a porosity and a
// seed.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>

namespace loam::engine {

/// Spheres in a periodic cell. Columns of `cell` are the cell's edge vectors (m); centres [3 x n] (m); radii
/// [n] (m).
struct Packing {
    Eigen::Matrix3d cell = Eigen::Matrix3d::Identity();
    Eigen::Matrix3Xd centres;
    Eigen::VectorXd radii;

    /// Volume of voids over volume of the cell; overlaps are counted twice, as laboratories count grains.
    double porosity() const;
    double void_ratio() const;
    double solid_volume() const;  // of the spheres (m³)
};

/// Throws std::invalid_argument when sizes differ, a number is not finite, a radius or the cell's volume is
/// not positive, or the cell is smaller than two particles.
void validate(const Packing& packing);

/// Sizes of the particles: radii uniform in mean·(1 ± spread) (De Pue et al. 2019 use 0.3).
struct PackingOptions {
    std::uint32_t particles = 700;
    double mean_radius = 0.055;       // m; quasi-static results do not depend on it
    double size_spread = 0.3;         // half width of the uniform distribution over its mean, in [0, 0.9]
    double target_porosity = 0.47;    // reached where friction allows, see PackingResult
    double stress = 2000.0;           // isotropic stress at which the packing rests (Pa)
    double stiffness_ratio = 2000.0;  // particle modulus over that stress
    double tolerance = 1e-3;          // on the porosity
    std::uint64_t seed = 1;

    void validate() const;
};

struct PackingResult {
    Packing packing;
    double porosity = 0;
    bool reached = false;  // within tolerance of the target
    double stress = 0;     // mean stress at the end (Pa), of the preparation's own particles
    std::uint64_t steps = 0;
    double seconds = 0;
    std::string stopped_by = "not run";
};

/// Makes a packing: a cloud without contacts is compacted isotropically with high friction and blocked
/// rotation; if it comes to rest looser than the target, friction is lowered until the target is met, then
/// raised again and the packing relaxed. Particles are soft on the way and have their stiffness for its last
/// part. The result depends on the options alone. When the loosest or densest
/// packing that friction can give is still off the target, the nearest one is returned with `reached` false.
/// `cancelled` is polled and makes it throw std::runtime_error.
PackingResult make_packing(const PackingOptions& options, const std::function<bool()>& cancelled = {});

}  // namespace loam::engine
