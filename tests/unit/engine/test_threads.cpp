// Several threads on one simulation: the same bits whatever their number.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <numeric>

#include "engine/loading.hpp"
#include "engine/simulation.hpp"

namespace loam::engine {
namespace {

TEST(Crew, DoesEveryTaskOnce) {
    for (const int threads : {1, 2, 5}) {
        Crew crew(threads);
        for (const std::size_t tasks : {std::size_t{0}, std::size_t{1}, std::size_t{3}, std::size_t{100}})
            for (int round = 0; round < 50; ++round) {
                std::vector<int> done(tasks, 0);
                crew.run(tasks, [&](std::size_t k) { ++done[k]; });
                EXPECT_EQ(std::accumulate(done.begin(), done.end(), 0), static_cast<int>(tasks));
                for (const int times : done) EXPECT_EQ(times, 1);
            }
        Crew copy(crew);
        EXPECT_EQ(copy.threads(), threads);
        copy = Crew(2);
        EXPECT_EQ(copy.threads(), 2);
    }
}

/// A packing of 16,000 that flies apart and is sheared and compressed: lists are made anew again and again.
Simulation run(const Packing& packing, const ContactLaw& law, bool free_rotation, int threads) {
    SimulationOptions options;
    options.free_rotation = free_rotation;
    options.threads = threads;
    Simulation simulation(packing, law, options);
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    gradient.diagonal() = Eigen::Vector3d(-6e-5, -3e-5, -1e-4) / simulation.time_step();
    gradient(0, 2) = 9e-5 / simulation.time_step();
    simulation.set_velocity_gradient(gradient);
    simulation.advance(500);
    return simulation;
}

class Threads : public testing::TestWithParam<bool> {};

TEST_P(Threads, GiveTheSameBitsWhateverTheirNumber) {
    PackingOptions options;
    options.particles = 16000;
    const Packing packing = make_packing(options).packing;
    ASSERT_GE(slab_count(16000, packing.cell, 2 * packing.radii.maxCoeff()), 4);
    ContactLaw law;
    if (GetParam()) law.rolling.friction = 0.1;
    const Simulation one = run(packing, law, GetParam(), 1);
    EXPECT_GT(one.rebuilds(), 5u);
    for (const int threads : {2, 3, 8}) {
        const Simulation several = run(packing, law, GetParam(), threads);
        EXPECT_EQ(several.packing().centres, one.packing().centres) << threads;
        EXPECT_EQ(several.velocities(), one.velocities()) << threads;
        EXPECT_EQ(several.measured().stress, one.measured().stress) << threads;
        EXPECT_EQ(several.measured().kinetic_energy, one.measured().kinetic_energy) << threads;
        EXPECT_EQ(several.contacts().size(), one.contacts().size());
        EXPECT_EQ(several.rebuilds(), one.rebuilds());
    }
}

INSTANTIATE_TEST_SUITE_P(Turning, Threads, testing::Bool(), [](const auto& info) {
    return std::string(info.param ? "FreeWithRollingResistance" : "Blocked");
});

/// Slabs whose pairs would meet are worked on as one.
TEST(Slabs, ThinOnesArePutTogether) {
    PackingOptions options;
    options.particles = 6500;
    const Packing packing = make_packing(options).packing;
    AlignedVector<ParticleRow> particles(6502);
    for (std::size_t p = 0; p < 6500; ++p)
        for (int k = 0; k < 3; ++k) {
            particles[p].x[k] = packing.centres(k, static_cast<Eigen::Index>(p));
            particles[p].radius = packing.radii[static_cast<Eigen::Index>(p)];
        }
    const Eigen::Matrix3d inverse = packing.cell.inverse();
    NeighbourGrid grid;
    grid.fill(particles, 6500, inverse, 2.2 * packing.radii.maxCoeff());
    std::vector<NearPair> near;
    std::vector<std::int32_t> part_of;
    Crew crew;
    const std::size_t pairs = grid.find_pairs(packing.cell, 0.06, crew, near);
    for (const int count : {1, 4, 16}) {
        Slabs slabs(count);
        slabs.sort_out(particles, 6500, inverse, near, pairs, part_of);
        const bool apart = count == 4;
        EXPECT_EQ(std::ranges::any_of(part_of, [](int part) { return part > 0; }), apart) << count;
        if (!apart) continue;
        // No particle is in two parts of the same kind.
        std::vector<std::int32_t> slab(6500, -1), face(6500, -1);
        for (std::size_t k = 0; k < pairs; ++k)
            for (const std::int32_t p : {near[k].i, near[k].j}) {
                auto& seen = (part_of[k] < count ? slab : face)[static_cast<std::size_t>(p)];
                EXPECT_TRUE(seen < 0 || seen == part_of[k]);
                seen = part_of[k];
            }
    }
}

}  // namespace
}  // namespace loam::engine
