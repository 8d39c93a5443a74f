// Face-centred cubic packings, regular or slightly disturbed, for tests against sums over bonds.
#pragma once

#include <array>
#include <cmath>
#include <random>

#include "engine/packing.hpp"

namespace loam::engine {

/// cells³ cubic cells of four spheres of radius 0.5 m; nearest neighbours are `spacing` apart (m).
inline Packing face_centred_cubic(int cells, double spacing) {
    const double a = spacing * std::sqrt(2.0);
    const std::array<Eigen::Vector3d, 4> basis{Eigen::Vector3d{0, 0, 0}, Eigen::Vector3d{0.5, 0.5, 0},
                                               Eigen::Vector3d{0.5, 0, 0.5}, Eigen::Vector3d{0, 0.5, 0.5}};
    const Eigen::Index count = 4 * cells * cells * cells;
    Packing packing;
    packing.cell = Eigen::Matrix3d::Identity() * cells * a;
    packing.centres.resize(3, count);
    packing.radii = Eigen::VectorXd::Constant(count, 0.5);
    Eigen::Index n = 0;
    for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells; ++j)
            for (int k = 0; k < cells; ++k)
                for (const Eigen::Vector3d& b : basis)
                    packing.centres.col(n++) = a * (Eigen::Vector3d(i, j, k) + b);
    return packing;
}

/// The same with radii smaller by up to `disorder`, so that contacts open, close and slide at strains of that
/// size. With linear springs its response has no other scale; everything that comes from finite turning is of
/// this order.
inline Packing disturbed_lattice(int cells, double disorder, unsigned seed) {
    Packing packing = face_centred_cubic(cells, 1.0 - disorder);
    std::mt19937_64 random(seed);
    for (double& radius : packing.radii)
        radius -= 0.5 * disorder * static_cast<double>(random() >> 11) * 0x1.0p-53;
    return packing;
}

}  // namespace loam::engine
