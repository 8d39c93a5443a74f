#include "engine/slabs.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace loam::engine {

int slab_count(std::size_t particles, const Eigen::Matrix3d& cell, double largest_diameter) {
    if (particles < 16000) return 1;  // parts cost a packing of 10,000 a tenth of its speed
    // A slab of three diameters keeps its faces apart while the cell shrinks by a quarter and more.
    const double thickness = 1.0 / cell.inverse().row(0).norm();
    int count = 1;
    while (count < static_cast<int>(most_slabs) && thickness >= 3 * largest_diameter * 2 * count) count *= 2;
    return count < 4 ? 1 : count;
}

bool Slabs::try_to_sort(const std::vector<NearPair>& near, std::size_t pairs,
                        std::vector<std::int32_t>& part_of) {
    std::fill(face_of_.begin(), face_of_.end(), -1);
    for (std::size_t k = 0; k < pairs; ++k) {
        const auto i = static_cast<std::size_t>(near[k].i), j = static_cast<std::size_t>(near[k].j);
        const int a = slab_of_[i], b = slab_of_[j];
        if (a == b) {
            part_of[k] = a;
            continue;
        }
        int lower = a;  // of the two, in the sense of the cell's period
        if ((b + 1) % count_ == a)
            lower = b;
        else if ((a + 1) % count_ != b)
            return false;
        for (const std::size_t p : {i, j}) {
            if (face_of_[p] >= 0 && face_of_[p] != lower) return false;
            face_of_[p] = lower;
        }
        part_of[k] = count_ + lower;
    }
    return true;
}

void Slabs::sort_out(const AlignedVector<ParticleRow>& particles, std::size_t count,
                     const Eigen::Matrix3d& inverse, const std::vector<NearPair>& near, std::size_t pairs,
                     std::vector<std::int32_t>& part_of) {
    part_of.assign(pairs, 0);
    if (count_ == 1) return;
    slab_of_.resize(count);
    face_of_.resize(count);
    for (std::size_t p = 0; p < count; ++p) {
        const double* x = particles[p].x;
        const double f = inverse(0, 0) * x[0] + inverse(0, 1) * x[1] + inverse(0, 2) * x[2];
        slab_of_[p] = std::clamp(static_cast<int>(f * count_), 0, count_ - 1);
    }
    if (!try_to_sort(near, pairs, part_of)) part_of.assign(pairs, 0);
}

}  // namespace loam::engine
