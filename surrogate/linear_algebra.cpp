#include "surrogate/linear_algebra.hpp"

#include "surrogate/dense/dense.hpp"

namespace loam::surrogate {

const DenseFunctions& dense_functions() {
    static const DenseFunctions& best =
        __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                __builtin_cpu_supports("avx512vl")
            ? dense_avx512
        : __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? dense_avx2
                                                                          : dense_baseline;
    return best;
}

namespace {

Eigen::VectorXd multiply(const Eigen::MatrixXd& lower, bool transposed, const Eigen::VectorXd& vector) {
    Eigen::VectorXd product(vector.size());
    dense_functions().multiply(static_cast<int>(lower.rows()), lower.data(), transposed, vector.data(),
                               product.data());
    return product;
}

}  // namespace

bool invert_factor(Eigen::MatrixXd& matrix, double& log_determinant) {
    return dense_functions().invert_factor(static_cast<int>(matrix.rows()), matrix.data(), &log_determinant);
}

void gram(const Eigen::MatrixXd& lower, Eigen::MatrixXd& product) {
    product.resize(lower.rows(), lower.rows());
    dense_functions().gram(static_cast<int>(lower.rows()), lower.data(), product.data());
}

Eigen::VectorXd lower_product(const Eigen::MatrixXd& lower, const Eigen::VectorXd& vector) {
    return multiply(lower, false, vector);
}

Eigen::MatrixXd lower_products(const Eigen::MatrixXd& lower, const Eigen::MatrixXd& vectors) {
    Eigen::MatrixXd products(vectors.rows(), vectors.cols());
    dense_functions().multiply_many(static_cast<int>(lower.rows()), lower.data(),
                                    static_cast<int>(vectors.cols()), vectors.data(), products.data());
    return products;
}

Eigen::VectorXd transposed_lower_product(const Eigen::MatrixXd& lower, const Eigen::VectorXd& vector) {
    return multiply(lower, true, vector);
}

}  // namespace loam::surrogate
