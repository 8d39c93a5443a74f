// Least squares against the certified results of NIST's Statistical Reference Datasets, nonlinear regression
// (https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml), and against closed forms.
#include "optimizers/least_squares.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

#include "optimizers/random.hpp"
#include "test_functions.hpp"

namespace loam::optimizers {
namespace {

using testing::vector;

/// Value of the model at one x with its derivatives by the parameters b.
using Model = std::function<double(double x, const Vector& b, Vector& slope)>;

struct NistProblem {
    Model model;
    Vector x, y;
    Vector lower, upper;  // a wide box around starts and solution: NIST's problems have no bounds
    std::vector<Vector> starts;
    Vector certified, certified_sd;
    double sum_of_squares;
};

Residuals residuals_of(const NistProblem& problem) {
    return [&problem](const Vector& b, Vector& residuals, Matrix* jacobian) {
        residuals.resize(problem.x.size());
        if (jacobian) jacobian->resize(problem.x.size(), b.size());
        Vector slope(b.size());
        for (Eigen::Index i = 0; i < problem.x.size(); ++i) {
            residuals(i) = problem.model(problem.x(i), b, slope) - problem.y(i);
            if (jacobian) jacobian->row(i) = slope.transpose();
        }
    };
}

NistProblem misra1a() {
    const Model model = [](double x, const Vector& b, Vector& slope) {
        const double decay = std::exp(-b(1) * x);
        slope << 1 - decay, b(0) * x * decay;
        return b(0) * (1 - decay);
    };
    return {model,
            vector({77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1,
                    760.0}),
            vector({10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47,
                    81.78}),
            vector({0, 0}),
            vector({1000, 0.01}),
            {vector({500, 1e-4}), vector({250, 5e-4})},
            vector({2.3894212918e+02, 5.5015643181e-04}),
            vector({2.7070075241e+00, 7.2668688436e-06}),
            1.2455138894e-01};
}

NistProblem mgh09() {
    const Model model = [](double x, const Vector& b, Vector& slope) {
        const double top = x * x + x * b(1), bottom = x * x + x * b(2) + b(3);
        const double value = b(0) * top / bottom;
        slope << top / bottom, b(0) * x / bottom, -value * x / bottom, -value / bottom;
        return value;
    };
    // The second of NIST's starts; from the first, far off, the way leads to a second minimum at infinity.
    return {model,
            vector({4, 2, 1, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625}),
            vector({0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246}),
            vector({0, 0, 0, 0}),
            vector({2, 2, 2, 2}),
            {vector({0.25, 0.39, 0.415, 0.39})},
            vector({1.9280693458e-01, 1.9128232873e-01, 1.2305650693e-01, 1.3606233068e-01}),
            vector({1.1435312227e-02, 1.9633220911e-01, 8.0842031232e-02, 9.0025542308e-02}),
            3.0750560385e-04};
}

NistProblem thurber() {
    const Model model = [](double x, const Vector& b, Vector& slope) {
        const double x2 = x * x, x3 = x2 * x;
        const double bottom = 1 + b(4) * x + b(5) * x2 + b(6) * x3;
        const double value = (b(0) + b(1) * x + b(2) * x2 + b(3) * x3) / bottom;
        slope << 1 / bottom, x / bottom, x2 / bottom, x3 / bottom, -value * x / bottom, -value * x2 / bottom,
            -value * x3 / bottom;
        return value;
    };
    return {model,
            vector({-3.067, -2.981, -2.921, -2.912, -2.840, -2.797, -2.702, -2.699, -2.633, -2.481,
                    -2.363, -2.322, -1.501, -1.460, -1.274, -1.212, -1.100, -1.046, -0.915, -0.714,
                    -0.566, -0.545, -0.400, -0.309, -0.109, -0.103, 0.010,  0.119,  0.377,  0.790,
                    0.963,  1.006,  1.115,  1.572,  1.841,  2.047,  2.200}),
            vector({80.574,   84.248,   87.264,   87.195,   89.076,   89.608,   89.868,   90.101,
                    92.405,   95.854,   100.696,  101.060,  401.672,  390.724,  567.534,  635.316,
                    733.054,  759.087,  894.206,  990.785,  1090.109, 1080.914, 1122.643, 1178.351,
                    1260.531, 1273.514, 1288.339, 1327.543, 1353.863, 1414.509, 1425.208, 1421.384,
                    1442.962, 1464.350, 1468.705, 1447.894, 1457.628}),
            vector({0, 0, 0, 0, 0, 0, 0}),
            vector({5000, 5000, 2000, 200, 2, 1, 0.2}),
            {vector({1000, 1000, 400, 40, 0.7, 0.3, 0.03}), vector({1300, 1500, 500, 75, 1, 0.4, 0.05})},
            vector({1.2881396800e+03, 1.4910792535e+03, 5.8323836877e+02, 7.5416644291e+01, 9.6629502864e-01,
                    3.9797285797e-01, 4.9727297349e-02}),
            vector({4.6647963344e+00, 3.9571156086e+01, 2.8698696102e+01, 5.5675370270e+00, 3.1333340687e-02,
                    1.4984928198e-02, 6.5842344623e-03}),
            5.6427082397e+03};
}

struct NistCase {
    const char* name;
    NistProblem (*make)();
};
void PrintTo(const NistCase& nist, std::ostream* stream) {
    *stream << nist.name;
}

class Nist : public ::testing::TestWithParam<NistCase> {};

TEST_P(Nist, GivesTheCertifiedParametersAndStandardDeviations) {
    const NistProblem problem = GetParam().make();
    for (const Vector& start : problem.starts) {
        Options options;
        options.relative_tolerance = 1e-14;
        const LeastSquares fit =
            minimise_least_squares(residuals_of(problem), {problem.lower, problem.upper}, start, options);
        SCOPED_TRACE("from " + std::to_string(start(0)));
        EXPECT_TRUE(fit.minimum.summary.converged) << fit.minimum.summary.stopped_by;
        EXPECT_NEAR(2 * fit.minimum.value, problem.sum_of_squares, 1e-9 * problem.sum_of_squares);
        const auto freedom = static_cast<double>(problem.x.size() - start.size());
        const Matrix variance = covariance(fit.jacobian).value() * (2 * fit.minimum.value / freedom);
        for (Eigen::Index i = 0; i < start.size(); ++i) {
            EXPECT_NEAR(fit.minimum.x(i), problem.certified(i), 1e-6 * problem.certified(i))
                << "parameter " << i;
            EXPECT_NEAR(std::sqrt(variance(i, i)), problem.certified_sd(i), 1e-6 * problem.certified_sd(i));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Problems, Nist,
                         ::testing::Values(NistCase{"Misra1a", misra1a}, NistCase{"MGH09", mgh09},
                                           NistCase{"Thurber", thurber}),
                         [](const auto& info) { return std::string(info.param.name); });

/// Residuals A x - b with their Jacobian.
Residuals linear(const Matrix& a, const Vector& b) {
    return [a, b](const Vector& x, Vector& residuals, Matrix* jacobian) {
        residuals = a * x - b;
        if (jacobian) *jacobian = a;
    };
}

TEST(LeastSquares, PriorsAsResidualsGiveTheGaussianPosterior) {
    // One reading y = 0.7 +- 0.1 of x0 + x1; priors x0 = 0.3 +- 0.2, x1 = 0.2 +- 0.1. By hand: the reading
    // misses the prior's prediction by 0.2 with variance 0.01 + 0.04 + 0.01 = 0.06, gains 0.04 / 0.06 and
    // 0.01 / 0.06.
    Matrix a(3, 2);
    a << 10, 10, 5, 0, 0, 10;
    const LeastSquares fit =
        minimise_least_squares(linear(a, vector({7, 1.5, 2})), unit_cube(2), vector({0.9, 0.9}));
    EXPECT_NEAR(fit.minimum.x(0), 0.3 + 0.2 * 4 / 6, 1e-10);
    EXPECT_NEAR(fit.minimum.x(1), 0.2 + 0.2 * 1 / 6, 1e-10);
    EXPECT_NEAR(fit.minimum.value, 0.5 * 0.2 * 0.2 / 0.06, 1e-10);
    const Matrix posterior = covariance(fit.jacobian).value();
    EXPECT_NEAR(posterior(0, 0), 0.04 - 0.04 * 0.04 / 0.06, 1e-12);
    EXPECT_NEAR(posterior(1, 1), 0.01 - 0.01 * 0.01 / 0.06, 1e-12);
    EXPECT_NEAR(posterior(0, 1), -0.04 * 0.01 / 0.06, 1e-12);
}

TEST(LeastSquares, StopsOnABoundAndSolvesTheRestThere) {
    // min (x0 + x1 - 3)^2 + (x0 - x1)^2 / 4 over [0, 1]^2 ends in the corner; with x0 <= 0.2, x1 free up to
    // 5, it lies at x0 = 0.2, where the derivative by x1 gives 1.25 x1 = 3 - 0.2 + 0.05.
    Matrix a(2, 2);
    a << 1, 1, 0.5, -0.5;
    const Residuals residuals = linear(a, vector({3, 0}));
    const LeastSquares corner = minimise_least_squares(residuals, unit_cube(2), vector({0.1, 0.4}));
    EXPECT_NEAR(corner.minimum.x(0), 1, 1e-12);
    EXPECT_NEAR(corner.minimum.x(1), 1, 1e-12);
    const Bounds narrow{vector({0, 0}), vector({0.2, 5})};
    Options tight;
    tight.relative_tolerance = 1e-13;
    const LeastSquares edge = minimise_least_squares(residuals, narrow, vector({0.1, 0.4}), tight);
    EXPECT_NEAR(edge.minimum.x(0), 0.2, 1e-12);
    EXPECT_NEAR(edge.minimum.x(1), 2.85 / 1.25, 1e-6);
}

TEST(LeastSquares, MeetsTheConditionsOfAMinimumOnRandomBoxes) {
    // Linear residuals: convex, so that the conditions of Karush, Kuhn and Tucker are the proof of the
    // minimum.
    Random random(7);
    int on_bounds = 0;
    for (int trial = 0; trial < 200; ++trial) {
        const Eigen::Index d = 1 + trial % 6;
        Matrix a(d + 2, d);
        for (double& entry : a.reshaped()) entry = random.normal();
        Vector b(d + 2);
        for (double& entry : b) entry = 2 * random.normal();
        const Bounds bounds{Vector::Constant(d, 0.1), Vector::Constant(d, 0.7)};
        const LeastSquares fit = minimise_least_squares(linear(a, b), bounds, Vector::Constant(d, 0.2));
        const Vector slope = a.transpose() * (a * fit.minimum.x - b);
        for (Eigen::Index i = 0; i < d; ++i) {
            const double x = fit.minimum.x(i);
            ASSERT_GE(x, 0.1);
            ASSERT_LE(x, 0.7);
            if (x == 0.1 || x == 0.7) ++on_bounds;
            const double step = std::clamp(x - slope(i), 0.1, 0.7) - x;
            ASSERT_NEAR(step, 0, 1e-5)
                << "trial " << trial << ", variable " << i << ": " << fit.minimum.summary.stopped_by;
        }
    }
    EXPECT_GT(on_bounds, 200);
}

TEST(LeastSquares, KeepsAFixedVariableWhereItIs) {
    const Bounds bounds{vector({0, 0.25}), vector({1, 0.25})};
    const LeastSquares fit = minimise_least_squares(linear(Matrix::Identity(2, 2), vector({0.4, 0.9})),
                                                    bounds, vector({0.1, 0.7}));
    EXPECT_NEAR(fit.minimum.x(0), 0.4, 1e-9);
    EXPECT_EQ(fit.minimum.x(1), 0.25);
    const LeastSquares all_fixed = minimise_least_squares(linear(Matrix::Identity(1, 1), vector({0.9})),
                                                          {vector({0.5}), vector({0.5})}, vector({0.5}));
    EXPECT_EQ(all_fixed.minimum.x(0), 0.5);
    EXPECT_EQ(all_fixed.minimum.summary.stopped_by, "all variables are fixed");
}

TEST(LeastSquares, HonoursItsBudgetAndStillReturnsTheJacobianThere) {
    const NistProblem problem = thurber();
    for (const int budget : {1, 2, 3, 7}) {
        int calls = 0;
        const Residuals inner = residuals_of(problem);
        const Residuals counted = [&](const Vector& b, Vector& r, Matrix* jacobian) {
            ++calls;
            inner(b, r, jacobian);
        };
        Options options;
        options.max_evaluations = budget;
        const LeastSquares fit =
            minimise_least_squares(counted, {problem.lower, problem.upper}, problem.starts[0], options);
        EXPECT_LE(calls, budget);
        EXPECT_EQ(fit.minimum.summary.evaluations, calls);
        EXPECT_FALSE(fit.minimum.summary.converged);
        EXPECT_EQ(fit.minimum.summary.stopped_by, "max_evaluations reached");
        Vector r;
        Matrix jacobian;
        inner(fit.minimum.x, r, &jacobian);
        EXPECT_EQ(fit.jacobian, jacobian);
        EXPECT_EQ(fit.residuals, r);
        EXPECT_DOUBLE_EQ(fit.minimum.value, 0.5 * r.squaredNorm());
    }
}

TEST(LeastSquares, ShortensStepsThatLeaveTheDomainOfTheResiduals) {
    // log x = log 0.02 from the far side: the first full step goes below zero, where there is no logarithm.
    const Residuals residuals = [](const Vector& x, Vector& r, Matrix* jacobian) {
        r = vector({std::log(x(0)) - std::log(0.02)});
        if (jacobian) *jacobian = Matrix::Constant(1, 1, 1 / x(0));
    };
    const LeastSquares fit = minimise_least_squares(residuals, {vector({-1}), vector({1})}, vector({0.9}),
                                                    {.relative_tolerance = 1e-12});
    EXPECT_NEAR(fit.minimum.x(0), 0.02, 1e-10);
}

TEST(LeastSquares, SaysWhyItCannotStart) {
    const Residuals broken = [](const Vector&, Vector& r, Matrix* jacobian) {
        r = vector({std::nan("")});
        if (jacobian) *jacobian = Matrix::Zero(1, 1);
    };
    try {
        minimise_least_squares(broken, unit_cube(1), vector({0.5}));
        FAIL() << "residuals that are not numbers were accepted";
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("not finite at the start"), std::string::npos)
            << error.what();
    }
}

TEST(LeastSquares, LetsExceptionsThrough) {
    int calls = 0;
    const Residuals throwing = [&](const Vector& x, Vector& r, Matrix* jacobian) {
        if (++calls == 3) throw std::domain_error("third call");
        r = vector({std::exp(x(0)) - 2});
        if (jacobian) *jacobian = Matrix::Constant(1, 1, std::exp(x(0)));
    };
    EXPECT_THROW(minimise_least_squares(throwing, unit_cube(1), vector({0.1})), std::domain_error);
    EXPECT_EQ(calls, 3);
}

TEST(LeastSquares, RefusesAChangingNumberOfResiduals) {
    int calls = 0;
    const Residuals growing = [&](const Vector& x, Vector& r, Matrix* jacobian) {
        r = Vector::Constant(++calls, x(0) - 0.3);
        if (jacobian) *jacobian = Matrix::Ones(calls, 1);
    };
    EXPECT_THROW(minimise_least_squares(growing, unit_cube(1), vector({0.9})), std::invalid_argument);
}

TEST(LeastSquares, IsSilent) {
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const Residuals failing = [](const Vector& x, Vector& r, Matrix* jacobian) {
        r = vector({x(0) == 0.5 ? 1.0 : std::nan("")});
        if (jacobian) *jacobian = Matrix::Ones(1, 1);
    };
    const LeastSquares fit = minimise_least_squares(failing, unit_cube(1), vector({0.5}));
    EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(fit.minimum.x(0), 0.5);
}

TEST(Covariance, SaysWhenADirectionIsNotDetermined) {
    Matrix a(3, 2);
    a << 1, 2, 2, 4, 3, 6;
    EXPECT_FALSE(covariance(a).has_value());
    EXPECT_FALSE(covariance(Matrix::Ones(1, 2)).has_value());
    a(0, 1) = 2.001;
    EXPECT_TRUE(covariance(a).has_value());
}

}  // namespace
}  // namespace loam::optimizers
