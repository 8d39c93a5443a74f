// The dense operations of linear_algebra.hpp on plain arrays, compiled once for each instruction set.
#pragma once

namespace loam::surrogate {

// Matrices are [n x n], column by column; those called lower have zeros, or nothing of interest, above the
// diagonal.

struct DenseFunctions {
    /// Replaces a symmetric positive definite matrix A = L L', of which the lower triangle is read, by the
    /// lower matrix L^-1, zeros included, and gives log |A|. False, A being left as it was, if A is not
    /// positive definite.
    bool (*invert_factor)(int n, double* matrix, double* log_determinant);
    /// Lower triangle of X' X for a lower matrix X with its zeros; what is above the diagonal of `gram` is
    /// overwritten.
    void (*gram)(int n, const double* lower, double* gram);
    /// product [n] = X v or X' v for a lower matrix X.
    void (*multiply)(int n, const double* lower, bool transposed, const double* vector, double* product);
    /// products [n x k] = X V for a lower matrix X with its zeros and V [n x k].
    void (*multiply_many)(int n, const double* lower, int k, const double* vectors, double* products);
    /// The kernels of kernels/, over n squared distances: value and slope [n].
    void (*matern52)(int n, const double* squared_distance, double* value, double* slope);
    void (*squared_exponential)(int n, const double* squared_distance, double* value, double* slope);
};

/// Those for the processor at hand.
const DenseFunctions& dense_functions();

extern const DenseFunctions dense_baseline, dense_avx2, dense_avx512;

}  // namespace loam::surrogate
