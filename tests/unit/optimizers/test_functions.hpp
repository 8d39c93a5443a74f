// Functions with published minima, with their gradients.
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "optimizers/problem.hpp"

namespace loam::optimizers::testing {

inline Vector vector(std::initializer_list<double> values) {
    Vector v(static_cast<Eigen::Index>(values.size()));
    Eigen::Index i = 0;
    for (const double value : values) v(i++) = value;
    return v;
}

inline Bounds box(Eigen::Index d, double lower, double upper) {
    return {Vector::Constant(d, lower), Vector::Constant(d, upper)};
}

/// Squared distance from (0.3, 0.3, …).
inline double sphere(const Vector& x, Vector* gradient) {
    const Vector from = x.array() - 0.3;
    if (gradient) *gradient = 2 * from;
    return from.squaredNorm();
}

/// Rosenbrock 1960; 0 at (1, 1, …).
inline double rosenbrock(const Vector& x, Vector* gradient) {
    double sum = 0;
    if (gradient) gradient->setZero(x.size());
    for (Eigen::Index i = 0; i + 1 < x.size(); ++i) {
        const double a = x(i + 1) - x(i) * x(i), b = 1 - x(i);
        sum += 100 * a * a + b * b;
        if (!gradient) continue;
        (*gradient)(i) += -400 * a * x(i) - 2 * b;
        (*gradient)(i + 1) += 200 * a;
    }
    return sum;
}

/// Rastrigin 1974; 0 at the origin, among minima one apart.
inline double rastrigin(const Vector& x, Vector* gradient) {
    constexpr double turn = 2 * std::numbers::pi;
    const auto angles = turn * x.array();
    if (gradient) *gradient = 2 * x.array() + 10 * turn * angles.sin();
    return (x.array().square() - 10 * angles.cos() + 10).sum();
}

/// Branin 1972, as in Dixon & Szego 1978; 0.397887 at (-pi, 12.275), (pi, 2.275), (9.42478, 2.475).
inline double branin(const Vector& x, Vector* gradient) {
    constexpr double pi = std::numbers::pi;
    constexpr double b = 5.1 / (4 * pi * pi), c = 5 / pi, t = 1 / (8 * pi);
    const double u = x(1) - b * x(0) * x(0) + c * x(0) - 6;
    if (gradient) *gradient = vector({2 * u * (c - 2 * b * x(0)) - 10 * (1 - t) * std::sin(x(0)), 2 * u});
    return u * u + 10 * (1 - t) * std::cos(x(0)) + 10;
}

/// Hartmann's function of six variables (Dixon & Szego 1978); -3.32237 on the unit cube at (0.20169,
/// 0.150011, 0.476874, 0.275332, 0.311652, 0.6573), with a broad second minimum of -3.2032.
inline double hartmann6(const Vector& x, Vector* gradient) {
    static const double a[4][6] = {{10, 3, 17, 3.5, 1.7, 8},
                                   {0.05, 10, 17, 0.1, 8, 14},
                                   {3, 3.5, 1.7, 10, 17, 8},
                                   {17, 8, 0.05, 10, 0.1, 14}};
    static const double p[4][6] = {{0.1312, 0.1696, 0.5569, 0.0124, 0.8283, 0.5886},
                                   {0.2329, 0.4135, 0.8307, 0.3736, 0.1004, 0.9991},
                                   {0.2348, 0.1451, 0.3522, 0.2883, 0.3047, 0.6650},
                                   {0.4047, 0.8828, 0.8732, 0.5743, 0.1091, 0.0381}};
    static const double c[4] = {1, 1.2, 3, 3.2};
    double sum = 0;
    if (gradient) gradient->setZero(6);
    for (int i = 0; i < 4; ++i) {
        double exponent = 0;
        for (int j = 0; j < 6; ++j) exponent += a[i][j] * std::pow(x(j) - p[i][j], 2);
        const double term = c[i] * std::exp(-exponent);
        sum -= term;
        if (!gradient) continue;
        for (int j = 0; j < 6; ++j) (*gradient)(j) += 2 * term * a[i][j] * (x(j) - p[i][j]);
    }
    return sum;
}

/// A minimisation with a known answer.
struct Problem {
    std::string name;
    Objective objective;
    Bounds bounds;
    Vector start;
    double minimum;
};

}  // namespace loam::optimizers::testing
