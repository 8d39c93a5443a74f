/// Random numbers whose bits are the same with every standard library: std::mt19937_64 is fixed by the
/// standard, std::*_distribution is not, so the transforms are written out here.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace loam::optimizers {

/// A 64-bit hash (the finaliser of splitmix64; Steele, Lea & Flood 2014): makes seeds of related streams
/// unrelated.
constexpr std::uint64_t hash(std::uint64_t value) {
    value += 0x9E3779B97F4A7C15ULL;
    value = (value ^ (value >> 30)) * 0xBF58476D1CE4E5B9ULL;
    value = (value ^ (value >> 27)) * 0x94D049BB133111EBULL;
    return value ^ (value >> 31);
}

class Random {
  public:
    /// Stream number `stream` of `seed`.
    explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : engine_(hash(hash(seed) + stream)) {}

    /// Uniform in the open interval (0, 1).
    double uniform() { return (static_cast<double>(engine_() >> 12) + 0.5) * 0x1p-52; }
    /// Uniform in {0, …, n - 1}; n >= 1. The bias, n / 2^52, is far below anything counted here.
    std::int64_t index(std::int64_t n) {
        return static_cast<std::int64_t>(uniform() * static_cast<double>(n));
    }

    /// Standard normal (Box & Muller 1958, in Marsaglia's polar form).
    double normal() {
        if (has_spare_) {
            has_spare_ = false;
            return spare_;
        }
        double u, v, s;
        do {
            u = 2 * uniform() - 1;
            v = 2 * uniform() - 1;
            s = u * u + v * v;
        } while (s >= 1 || s == 0);
        const double scale = std::sqrt(-2 * std::log(s) / s);
        spare_ = v * scale;
        has_spare_ = true;
        return u * scale;
    }

  private:
    std::mt19937_64 engine_;
    double spare_ = 0;
    bool has_spare_ = false;
};

}  // namespace loam::optimizers
