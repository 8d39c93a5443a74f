// The loops of a step over contacts and particles, on one thread or on several (simulation.hpp).
#include <algorithm>
#include <array>

#include "engine/kernel/kernel.hpp"
#include "engine/simulation.hpp"

namespace loam::engine {
namespace {

void to_row_major(const Eigen::Matrix3d& m, double (&out)[9]) {
    for (int p = 0; p < 3; ++p)
        for (int q = 0; q < 3; ++q) out[3 * p + q] = m(p, q);
}

}  // namespace

ContactLoop Simulation::contact_loop(Measure measure) const {
    const ContactLoops& loops = composition_.with_effects ? *kernel_->with_effects : kernel_->contacts;
    return loops.by[composition_.base][static_cast<int>(composition_.turning)][static_cast<int>(measure)];
}

void Simulation::point_to(PairList& pairs, std::size_t first, std::size_t last, ContactArguments& a) {
    a.padded_pairs = last - first;
    a.row_i = pairs.row_i.data() + first;
    a.row_j = pairs.row_j.data() + first;
    a.image = pairs.image.data() + first;
    a.radius_sum = pairs.radius_sum.data() + first;
    a.reduced_radius = pairs.reduced_radius.data() + first;
    a.area = pairs.area.data() + first;
    a.shear_x = pairs.shear[0].data() + first;
    a.shear_y = pairs.shear[1].data() + first;
    a.shear_z = pairs.shear[2].data() + first;
    a.bond = pairs.bond.data() + first;
    for (std::size_t q = 0; q < pairs.further.size(); ++q) a.further[q] = pairs.further[q].data() + first;
}

/// First the slabs, which share no particle, then their faces, which share none either; the sums are added in
/// the order of the parts.
void Simulation::contact_forces(ContactSums& sums, Measure measure) {
    alignas(64) double shifts[image_count][8] = {};
    for (int n = 0; n < image_count; ++n) {
        const Eigen::Vector3d s = cell_ * Eigen::Vector3d(n / 9 - 1, (n / 3) % 3 - 1, n % 3 - 1);
        for (int k = 0; k < 3; ++k) shifts[n][k] = s[k];
    }
    ContactArguments a{};
    a.particles = particles_.data();
    a.spins = spins_.data();
    a.forces = forces_.data();
    a.shifts = &shifts[0][0];
    to_row_major(gradient_, a.velocity_gradient);
    a.dt = dt_;
    a.law = composition_.numbers;
    const std::size_t parts = pairs_.parts.size();
    std::array<ContactSums, 2 * most_slabs> of_part{};
    const ContactLoop loop = contact_loop(measure);
    for (std::size_t start = 0; start < parts; start += static_cast<std::size_t>(slabs_.count())) {
        const std::size_t end = std::min(parts, start + static_cast<std::size_t>(slabs_.count()));
        crew_.run(end - start, [&](std::size_t k) {
            const std::size_t p = start + k;
            ContactArguments of_this = a;
            point_to(pairs_, pairs_.parts[p].first, reachable_[p], of_this);
            loop(of_this, of_part[p]);
        });
    }
    for (std::size_t p = 0; p < parts; ++p) sums += of_part[p];
    if (!walls_.empty()) wall_forces(a, sums, measure);
}

void Simulation::integrate(IntegrateSums& sums, Measure measure) {
    const auto pieces = static_cast<std::size_t>(slabs_.count());
    std::array<IntegrateSums, most_slabs> of_piece{};
    // Pairs of particles share a vector, so that every piece but the last is even.
    const std::size_t size = (count_ / pieces + 1) / 2 * 2;
    crew_.run(pieces, [&](std::size_t piece) {
        const std::size_t first = std::min(count_, piece * size),
                          last = piece + 1 == pieces ? count_ : std::min(count_, first + size);
        IntegrateArguments a{};
        a.particles = particles_.data() + first;
        a.spins = options_.free_rotation ? spins_.data() + first : nullptr;
        a.forces = forces_.data() + first;
        a.count = last - first;
        to_row_major(gradient_, a.velocity_gradient);
        a.dt = dt_;
        a.damping = options_.damping;
        kernel_->integrate[options_.free_rotation][static_cast<int>(measure)](a, of_piece[piece]);
    });
    for (std::size_t piece = 0; piece < pieces; ++piece) sums += of_piece[piece];
}

}  // namespace loam::engine
