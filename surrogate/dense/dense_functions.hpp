// The body that baseline.cpp, avx2.cpp and avx512.cpp compile with their own flags; included nowhere else.
#pragma once

#include <Eigen/Dense>

#include "surrogate/dense/dense.hpp"
#include "surrogate/kernels/matern52.hpp"
#include "surrogate/kernels/squared_exponential.hpp"

namespace loam::surrogate {
namespace {

// Columns treated together: the triangular products below skip the zeros of L^-1 in steps of this.
constexpr int block = 64;

// Eigen sums in an order that depends on where arrays begin, so all work is done on its own, aligned ones:
// the same numbers must give the same bits wherever the caller keeps them.

bool invert_factor(int n, double* matrix, double* log_determinant) {
    // Fixed, not asked of the processor: block sizes decide the order of sums, too.
    static const bool fixed = (Eigen::setCpuCacheSizes(32 << 10, 512 << 10, 2 << 20), true);
    static_cast<void>(fixed);
    Eigen::MatrixXd a = Eigen::Map<Eigen::MatrixXd>(matrix, n, n);
    if (Eigen::internal::llt_inplace<double, Eigen::Lower>::blocked(a) != -1) return false;
    *log_determinant = 2 * a.diagonal().array().log().sum();
    Eigen::MatrixXd x = Eigen::MatrixXd::Identity(n, n);
    for (int j = 0; j < n; j += block) {
        const int width = n - j < block ? n - j : block, rest = n - j;
        auto columns = x.block(j, j, rest, width);
        a.block(j, j, rest, rest).template triangularView<Eigen::Lower>().solveInPlace(columns);
    }
    Eigen::Map<Eigen::MatrixXd>(matrix, n, n) = x;
    return true;
}

void gram(int n, const double* lower, double* gram) {
    const Eigen::MatrixXd x = Eigen::Map<const Eigen::MatrixXd>(lower, n, n);
    Eigen::MatrixXd product(n, n);
    for (int j = 0; j < n; j += block) {
        const int width = n - j < block ? n - j : block, rest = n - j;
        product.block(j, j, rest, width).noalias() =
            x.block(j, j, rest, rest).transpose().template triangularView<Eigen::Upper>() *
            x.block(j, j, rest, width);
        product.block(0, j, j, width).setZero();
    }
    Eigen::Map<Eigen::MatrixXd>(gram, n, n) = product;
}

void multiply(int n, const double* lower, bool transposed, const double* vector, double* product) {
    const Eigen::Map<const Eigen::MatrixXd> x(lower, n, n);
    const Eigen::VectorXd from = Eigen::Map<const Eigen::VectorXd>(vector, n);
    Eigen::VectorXd to(n);
    if (transposed) {
        to.noalias() = x.transpose().template triangularView<Eigen::Upper>() * from;
    } else {
        to.noalias() = x.template triangularView<Eigen::Lower>() * from;
    }
    Eigen::Map<Eigen::VectorXd>(product, n) = to;
}

void multiply_many(int n, const double* lower, int k, const double* vectors, double* products) {
    const Eigen::MatrixXd from = Eigen::Map<const Eigen::MatrixXd>(vectors, n, k);
    const Eigen::Map<const Eigen::MatrixXd> x(lower, n, n);
    Eigen::MatrixXd to(n, k);
    for (int i = 0; i < n; i += block) {
        const int height = n - i < block ? n - i : block;
        to.middleRows(i, height).noalias() = x.block(i, 0, height, i + height) * from.topRows(i + height);
    }
    Eigen::Map<Eigen::MatrixXd>(products, n, k) = to;
}

/// In aligned stretches of full vectors, so that an entry's bits do not depend on its place.
template <class Kernel>
void in_stretches(int n, const double* squared_distance, double* value, double* slope, Kernel kernel) {
    using Stretch = Eigen::Array<double, block, 1>;
    Stretch from = Stretch::Zero(), v, s;
    for (int i = 0; i < n; i += block) {
        const int length = n - i < block ? n - i : block;
        for (int k = 0; k < length; ++k) from[k] = squared_distance[i + k];
        kernel(from, v, s);
        for (int k = 0; k < length; ++k) value[i + k] = v[k];
        for (int k = 0; k < length; ++k) slope[i + k] = s[k];
    }
}

void matern52_of(int n, const double* squared_distance, double* value, double* slope) {
    in_stretches(n, squared_distance, value, slope,
                 [](const auto& r2, auto& v, auto& s) { matern52(r2, v, s); });
}

void squared_exponential_of(int n, const double* squared_distance, double* value, double* slope) {
    in_stretches(n, squared_distance, value, slope,
                 [](const auto& r2, auto& v, auto& s) { squared_exponential(r2, v, s); });
}

constexpr DenseFunctions functions{invert_factor, gram,        multiply,
                                   multiply_many, matern52_of, squared_exponential_of};

}  // namespace
}  // namespace loam::surrogate
