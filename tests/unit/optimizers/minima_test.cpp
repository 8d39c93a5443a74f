// The minima that are published for standard functions.
#include <gtest/gtest.h>

#include <vector>

#include "optimizers/registry.hpp"
#include "test_functions.hpp"

namespace loam::optimizers {
namespace {

using testing::box;
using testing::Problem;
using testing::vector;

std::vector<Problem> smooth_problems() {
    return {
        {"Rosenbrock of 2", testing::rosenbrock, box(2, -2, 2), vector({-1.2, 1}), 0},
        {"Rosenbrock of 5", testing::rosenbrock, box(5, -2, 2), Vector::Constant(5, -1.2), 0},
        {"Branin", testing::branin, {vector({-5, 0}), vector({10, 15})}, vector({2, 2}), 0.397887},
        {"Hartmann of 6", testing::hartmann6, unit_cube(6), Vector::Constant(6, 0.4), -3.32237},
    };
}

std::vector<Problem> rough_problems() {
    return {
        {"Rosenbrock of 2", testing::rosenbrock, box(2, -2, 2), vector({-1.2, 1}), 0},
        // Not symmetric about the origin, which would be the first point of a search by division.
        {"Rastrigin of 2", testing::rastrigin, box(2, -4.1, 5.6), vector({3.3, 3.3}), 0},
        {"Branin", testing::branin, {vector({-5, 0}), vector({10, 15})}, vector({2, 2}), 0.397887},
        {"Hartmann of 6", testing::hartmann6, unit_cube(6), Vector::Constant(6, 0.4), -3.32237},
    };
}

TEST(TestFunctions, HaveTheGradientsTheyClaim) {
    for (const auto& problems : {smooth_problems(), rough_problems()}) {
        for (const Problem& problem : problems) {
            const Vector x = problem.bounds.lower + 0.37 * (problem.bounds.upper - problem.bounds.lower);
            Vector gradient(x.size());
            problem.objective(x, &gradient);
            for (Eigen::Index i = 0; i < x.size(); ++i) {
                Vector above = x, below = x;
                above(i) += 1e-5;
                below(i) -= 1e-5;
                const double slope =
                    (problem.objective(above, nullptr) - problem.objective(below, nullptr)) / 2e-5;
                EXPECT_NEAR(gradient(i), slope, 1e-5 * (1 + std::abs(slope)))
                    << problem.name << ", variable " << i;
            }
        }
    }
}

TEST(LocalSearch, WithGradientsEndsInTheMinimum) {
    for (const Problem& problem : smooth_problems()) {
        for (const char* name : {"lbfgs", "slsqp"}) {
            const Minimum found = minimise(name, problem.objective, problem.bounds, problem.start);
            EXPECT_NEAR(found.value, problem.minimum, 5e-6) << name << " on " << problem.name;
            EXPECT_TRUE(found.summary.converged)
                << name << " on " << problem.name << ": " << found.summary.stopped_by;
            EXPECT_LE(found.summary.evaluations, 200) << name << " on " << problem.name;
        }
    }
}

TEST(LocalSearch, WithoutGradientsEndsInTheMinimum) {
    for (const Problem& problem : smooth_problems()) {
        if (problem.bounds.size() == 5) continue;  // the valley of five variables is too long for simplices
        const Minimum found = minimise("sbplx", problem.objective, problem.bounds, problem.start);
        EXPECT_NEAR(found.value, problem.minimum, 1e-5) << problem.name;
        EXPECT_TRUE(found.summary.converged) << problem.name << ": " << found.summary.stopped_by;
    }
}

TEST(GlobalSearch, FindsTheBestOfManyMinima) {
    for (const Problem& problem : rough_problems()) {
        for (const char* name : {"direct-l", "crs2", "multistart-lbfgs"}) {
            for (const std::uint64_t seed : {1, 2, 3}) {
                const Minimum found = minimise(name, problem.objective, problem.bounds, problem.start,
                                               {.max_evaluations = 20000, .seed = seed});
                EXPECT_NEAR(found.value, problem.minimum, 1e-5) << name << " on " << problem.name << ", seed "
                                                                << seed << ": " << found.summary.stopped_by;
            }
        }
    }
}

TEST(GlobalSearch, FromManyStartsEndsEarlyOnASingleMinimum) {
    const Minimum found =
        minimise("multistart-lbfgs", testing::sphere, unit_cube(6), Vector::Constant(6, 0.9));
    EXPECT_TRUE(found.summary.converged);
    EXPECT_EQ(found.summary.stopped_by, "less than half a minimum is expected to be unseen");
    EXPECT_LE(found.summary.evaluations, 150);
}

TEST(GlobalSearch, FromManyStartsGoesOnAfterAStartWithoutAValue) {
    const Objective holed = [](const Vector& x, Vector* gradient) {
        return x(0) > 0.8 ? std::nan("") : testing::sphere(x, gradient);
    };
    const Minimum found = minimise("multistart-lbfgs", holed, unit_cube(2), Vector::Constant(2, 0.9));
    EXPECT_NEAR(found.value, 0, 1e-12);
}

}  // namespace
}  // namespace loam::optimizers
