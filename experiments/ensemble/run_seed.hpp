// Random numbers of a run depend on (campaign seed, run index) alone, so that any run can be made anywhere,
// in any order, and comes out the same.
#pragma once

#include <cstdint>

namespace loam::experiments {

/// The output function of SplitMix64 (Steele, Lea and Flood 2014): a bijection whose every output bit depends
/// on every input bit. The generator's n-th number from state s is splitmix64(s + (n - 1) *
/// 0x9e3779b97f4a7c15).
constexpr std::uint64_t splitmix64(std::uint64_t state) {
    std::uint64_t z = state + 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/// The seed of one stream of random numbers (packing, noise, ... as the caller numbers them) of one run.
/// For a fixed campaign and stream, different indices give different seeds without exception (each step is a
/// bijection of the index); across campaigns and streams they collide no more often than random numbers do.
constexpr std::uint64_t run_seed(std::uint64_t campaign_seed, std::uint64_t index, std::uint64_t stream = 0) {
    const std::uint64_t campaign = splitmix64(splitmix64(campaign_seed) + stream);
    return splitmix64(campaign ^ splitmix64(index));
}

}  // namespace loam::experiments
