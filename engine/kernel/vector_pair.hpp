// Two narrower vectors as one, for rows that are wider than a register. To be included after the functions of
// the narrower ones.
#pragma once

namespace loam::engine {
namespace {

#define LOAM_INLINE_FRIEND friend inline __attribute__((always_inline))

/// Outcome of comparing two pairs.
template <class M>
struct MaskPair {
    M a, b;
};

template <class V>
struct Pair {
    V a, b;

    Pair() = default;
    Pair(V lower, V upper) : a(lower), b(upper) {}
    Pair(double s)
        : a(splat_as<V>(s)), b(a) {}  // so that numbers mix with vectors, as with the compilers' own

    LOAM_INLINE_FRIEND Pair operator+(Pair x, Pair y) { return {x.a + y.a, x.b + y.b}; }
    LOAM_INLINE_FRIEND Pair operator-(Pair x, Pair y) { return {x.a - y.a, x.b - y.b}; }
    LOAM_INLINE_FRIEND Pair operator*(Pair x, Pair y) { return {x.a * y.a, x.b * y.b}; }
    LOAM_INLINE_FRIEND Pair operator/(Pair x, Pair y) { return {x.a / y.a, x.b / y.b}; }
    LOAM_INLINE_FRIEND Pair& operator+=(Pair& x, Pair y) { return x = x + y; }
    LOAM_INLINE_FRIEND auto operator<(Pair x, Pair y) {
        return MaskPair<decltype(x.a < y.a)>{x.a < y.a, x.b < y.b};
    }
    LOAM_INLINE_FRIEND auto operator>(Pair x, Pair y) { return y < x; }
};

template <class M, class V>
LOAM_INLINE Pair<V> choose(const MaskPair<M>& mask, Pair<V> x, Pair<V> y) {
    return {choose(mask.a, x.a, y.a), choose(mask.b, x.b, y.b)};
}
template <class V>
LOAM_INLINE Pair<V> larger(Pair<V> x, Pair<V> y) {
    return {larger(x.a, y.a), larger(x.b, y.b)};
}
template <class V>
LOAM_INLINE double sum(Pair<V> x) {
    return sum(x.a) + sum(x.b);
}
template <class V>
LOAM_INLINE double lane(Pair<V> x, int k) {
    constexpr int half = sizeof(V) / sizeof(double);
    return k < half ? lane(x.a, k) : lane(x.b, k - half);
}

}  // namespace
}  // namespace loam::engine
