// The state that the inner loops work on: particles as rows of one cache line, contacts as contiguous arrays.
// A particle row is what a contact needs of a particle, so that eight contacts cost sixteen aligned loads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "engine/contact/law_numbers.hpp"

namespace loam::engine {

/// Allocator with the alignment of a cache line, for rows and vector loads.
template <class T>
struct AlignedAllocator {
    using value_type = T;
    AlignedAllocator() = default;
    template <class U>
    explicit AlignedAllocator(const AlignedAllocator<U>&) {}
    T* allocate(std::size_t n) {
        return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{64}));
    }
    void deallocate(T* p, std::size_t) noexcept { ::operator delete (p, std::align_val_t{64}); }
    template <class U>
    bool operator==(const AlignedAllocator<U>&) const {
        return true;
    }
};
template <class T>
using AlignedVector = std::vector<T, AlignedAllocator<T>>;

/// Position (m), radius (m), velocity relative to the mean velocity field L·x (m/s), and 1/mass (1/kg).
struct alignas(64) ParticleRow {
    double x[3], radius, v[3], inverse_mass;
};

/// radius × angular velocity (m/s), angular velocity (rad/s), 1/moment of inertia.
struct alignas(64) SpinRow {
    double radius_spin[3], unused, spin[3], inverse_inertia;
};

/// Force (N) on a particle, and moment over its radius (N), summed over its contacts.
struct alignas(64) ForceRow {
    double force[3], unused0, moment_per_radius[3], unused1;
};

/// All rows have this size, so that one offset finds a particle in every array.
inline constexpr std::size_t row_bytes = 64;

/// Sections of the pair list: pairs that touch, then pairs by the size of their gap when the list was made.
inline constexpr int gap_sections = 17;

/// The section of a pair without a bond from d²/(R_i + R_j)².
std::int32_t gap_section(double closeness, double skin);

/// The neighbour pairs. Every part is padded to a multiple of eight with a pair of dummies that never touch,
/// and ordered by sections, so that pairs which cannot have met yet are left out and those that touch fill
/// whole groups.
struct PairList {
    std::size_t count = 0;                       // without padding
    AlignedVector<std::int32_t> i, j;            // particles, i < j
    AlignedVector<std::int32_t> image;           // which copy of j: index into the table of 27 cell shifts
    AlignedVector<std::uint32_t> row_i, row_j;   // where their rows start (bytes)
    AlignedVector<double> radius_sum;            // R_i + R_j (m)
    AlignedVector<double> reduced_radius;        // R_i R_j / (R_i + R_j) (m)
    AlignedVector<double> area;                  // min(R_i, R_j)² (m²): adhesion is cohesion times this
    AlignedVector<double> shear[3];              // shear force on i (N): the contact's history
    AlignedVector<double> bond;                  // bond state, or what the law keeps in its place
    std::vector<AlignedVector<double>> further;  // history that sub-models of the law declare

    std::size_t padded() const { return i.size(); }
    void resize_padded(std::size_t n);

    /// A stretch of the list that begins and ends with whole groups of eight pairs.
    struct Part {
        std::size_t first = 0, last = 0;
        std::array<std::size_t, gap_sections> section_end{};  // one past the last pair
    };
    std::vector<Part> parts;
    std::array<double, gap_sections> section_gap{};  // smallest gap over R_i + R_j

    /// How far a part must be gone through where pairs have moved by up to motion·(R_i + R_j): one past the
    /// last that can touch.
    std::size_t within_reach(const Part& part, double motion) const;
};

/// Image index of the copy shifted by (a, b, c) cells, each in -1..1, and back.
constexpr int image_index(int a, int b, int c) {
    return (a + 1) * 9 + (b + 1) * 3 + (c + 1);
}
inline constexpr int image_count = 27;
inline constexpr int image_home = image_index(0, 0, 0);

}  // namespace loam::engine
