// What every optimiser of the table must do, whatever its method.
#include "optimizers/registry.hpp"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "test_functions.hpp"

namespace loam::optimizers {

void PrintTo(const Optimiser& optimiser, std::ostream* stream) {
    *stream << optimiser.name;
}

namespace {

using testing::box;
using testing::vector;

/// How far apart seconds are is no part of an answer; all else is.
bool same(const Minimum& a, const Minimum& b) {
    return a.x == b.x && a.value == b.value && a.summary.evaluations == b.summary.evaluations &&
           a.summary.stopped_by == b.summary.stopped_by && a.summary.converged == b.summary.converged;
}

class EveryOptimiser : public ::testing::TestWithParam<Optimiser> {
  protected:
    static Minimum run(const Objective& objective, const Bounds& bounds, const Vector& start,
                       const Options& options = {}) {
        return minimise(GetParam().name, objective, bounds, start, options);
    }
};

INSTANTIATE_TEST_SUITE_P(Table, EveryOptimiser, ::testing::ValuesIn(optimisers().begin(), optimisers().end()),
                         [](const auto& info) {
                             std::string name(info.param.name);
                             for (char& letter : name) letter = letter == '-' ? '_' : letter;
                             return name;
                         });

TEST_P(EveryOptimiser, FindsTheMinimumOfASphereInsideItsBounds) {
    for (const Eigen::Index d : {1, 2, 4}) {
        const Minimum found = run(testing::sphere, unit_cube(d), Vector::Constant(d, 0.85));
        EXPECT_NEAR(found.value, 0, 1e-8) << d << " variables: " << found.summary.stopped_by;
        EXPECT_LT((found.x.array() - 0.3).abs().maxCoeff(), 1e-4);
        EXPECT_DOUBLE_EQ(found.value, testing::sphere(found.x, nullptr));
    }
}

TEST_P(EveryOptimiser, FindsAMinimumOnTheBounds) {
    // The sphere's centre lies outside in the first two variables; the nearest point of the box is (0.5,
    // -0.2, 0.3).
    const Bounds bounds{vector({0.5, -2, -1}), vector({2, -0.2, 3})};
    const Minimum found = run(testing::sphere, bounds, vector({1.5, -1, 2}));
    EXPECT_NEAR(found.value, 0.04 + 0.25, 1e-6) << found.summary.stopped_by;
    EXPECT_NEAR(found.x(0), 0.5, 1e-6);
    EXPECT_NEAR(found.x(1), -0.2, 1e-6);
    EXPECT_NEAR(found.x(2), 0.3, 1e-3);
}

TEST_P(EveryOptimiser, NeverLeavesTheBounds) {
    // Bounds whose width is not a binary fraction, and a function that falls towards a corner.
    const Bounds bounds{vector({0.1, -3.7, 1e-3}), vector({0.3, 1.1, 7e-3})};
    const Objective guarded = [&](const Vector& x, Vector* gradient) {
        EXPECT_TRUE((x.array() >= bounds.lower.array()).all() && (x.array() <= bounds.upper.array()).all());
        if (gradient) *gradient = vector({-1, 1, -100});
        return x(1) - x(0) - 100 * x(2);
    };
    const Minimum found = run(guarded, bounds, vector({0.2, 0, 5e-3}), {.max_evaluations = 600});
    EXPECT_NEAR(found.value, -3.7 - 0.3 - 0.7, 0.02);
    EXPECT_TRUE((found.x.array() >= bounds.lower.array()).all() &&
                (found.x.array() <= bounds.upper.array()).all());
}

TEST_P(EveryOptimiser, HonoursItsBudgetToTheCall) {
    for (const int budget : {1, 2, 7, 100}) {
        int calls = 0;
        const Objective counted = [&](const Vector& x, Vector* gradient) {
            ++calls;
            return testing::rosenbrock(x, gradient);
        };
        const Minimum found =
            run(counted, box(5, -2, 2), Vector::Constant(5, -1.2), {.max_evaluations = budget});
        EXPECT_LE(calls, budget);
        EXPECT_EQ(found.summary.evaluations, calls);
        EXPECT_EQ(found.summary.converged, calls < budget);
        EXPECT_EQ(found.summary.stopped_by == "max_evaluations reached", calls == budget);
    }
}

TEST_P(EveryOptimiser, HonoursItsTime) {
    const Objective slow = [](const Vector& x, Vector* gradient) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        return testing::rosenbrock(x, gradient);
    };
    const Minimum found = run(slow, box(5, -2, 2), Vector::Constant(5, -1.2),
                              {.max_evaluations = 100000, .relative_tolerance = 1e-15, .max_seconds = 0.02});
    EXPECT_EQ(found.summary.stopped_by, "max_seconds reached");
    EXPECT_FALSE(found.summary.converged);
    EXPECT_LE(found.summary.evaluations, 11);
}

TEST_P(EveryOptimiser, RepeatsUnderASeedAlsoBesideOthers) {
    const auto once = [&](std::uint64_t seed) {
        return run(testing::hartmann6, unit_cube(6), Vector::Constant(6, 0.5),
                   {.max_evaluations = 1500, .seed = seed});
    };
    const Minimum first = once(11), other = once(12);
    EXPECT_TRUE(same(first, once(11)));
    constexpr std::size_t count = 4;
    std::vector<Minimum> results(count);
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < count; ++i) {
        threads.emplace_back([&, i] { results[i] = once(i % 2 == 0 ? 11 : 12); });
    }
    for (std::thread& thread : threads) thread.join();
    for (std::size_t i = 0; i < count; ++i) EXPECT_TRUE(same(results[i], i % 2 == 0 ? first : other)) << i;
}

TEST_P(EveryOptimiser, AsksForGradientsIfAndOnlyIfItSaysSo) {
    int with = 0;
    const Objective watched = [&](const Vector& x, Vector* gradient) {
        if (gradient) {
            ++with;
            EXPECT_EQ(gradient->size(), x.size());
        }
        return testing::rosenbrock(x, gradient);
    };
    run(watched, box(2, -2, 2), vector({-1.2, 1}), {.max_evaluations = 200});
    EXPECT_EQ(with > 0, GetParam().needs_gradient);
}

TEST_P(EveryOptimiser, KeepsAwayFromPointsThatAreNotNumbers) {
    // No value beyond x0 = 0.6, between the start and nothing; and infinities beyond x1 = 0.7.
    const Objective holed = [](const Vector& x, Vector* gradient) {
        if (x(0) > 0.6) return std::nan("");
        if (x(1) > 0.7) return x(2) > 0.5 ? HUGE_VAL : -HUGE_VAL;
        return testing::sphere(x, gradient);
    };
    const Minimum found = run(holed, unit_cube(3), Vector::Constant(3, 0.55));
    EXPECT_NEAR(found.value, 0, 1e-6) << found.summary.stopped_by;
}

TEST_P(EveryOptimiser, SaysSoWhenNothingIsANumber) {
    const Objective broken = [](const Vector& x, Vector* gradient) {
        if (gradient) gradient->setZero(x.size());
        return std::nan("");
    };
    try {
        run(broken, unit_cube(2), Vector::Constant(2, 0.5), {.max_evaluations = 300});
        FAIL() << "a minimum of nothing";
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("finite at none of the"), std::string::npos) << error.what();
    }
}

TEST_P(EveryOptimiser, LetsExceptionsThrough) {
    for (const int last : {1, 5, 50}) {
        int calls = 0;
        const Objective throwing = [&](const Vector& x, Vector* gradient) {
            if (++calls == last) throw std::domain_error("enough");
            return testing::rosenbrock(x, gradient);
        };
        const auto attempt = [&] { run(throwing, box(5, -2, 2), Vector::Constant(5, -1.2)); };
        if (GetParam().scope == Scope::local && last == 50) continue;  // some are done by then
        EXPECT_THROW(attempt(), std::domain_error);
        EXPECT_EQ(calls, last);
    }
}

TEST_P(EveryOptimiser, LeavesFixedVariablesAlone) {
    const Bounds bounds{vector({0, 0.9, 0}), vector({1, 0.9, 1})};
    const Minimum found = run(testing::sphere, bounds, vector({0.8, 0.1, 0.8}));
    EXPECT_EQ(found.x(1), 0.9);
    EXPECT_NEAR(found.value, 0.36, 1e-8);
    const Bounds point{vector({0.4, 0.9}), vector({0.4, 0.9})};
    const Minimum single = run(testing::sphere, point, vector({0, 0}));
    EXPECT_EQ(single.x, point.lower);
    EXPECT_EQ(single.summary.evaluations, 1);
    EXPECT_TRUE(single.summary.converged);
}

TEST_P(EveryOptimiser, RefusesUnsoundArguments) {
    const Vector start = Vector::Constant(2, 0.5);
    EXPECT_THROW(run(testing::sphere, {vector({0, 0}), vector({1})}, start), std::invalid_argument);
    EXPECT_THROW(run(testing::sphere, {vector({0, 2}), vector({1, 1})}, start), std::invalid_argument);
    EXPECT_THROW(run(testing::sphere, {vector({0, 0}), vector({1, HUGE_VAL})}, start), std::invalid_argument);
    EXPECT_THROW(run(testing::sphere, unit_cube(3), start), std::invalid_argument);
    EXPECT_THROW(run(testing::sphere, unit_cube(2), vector({0.5, std::nan("")})), std::invalid_argument);
    EXPECT_THROW(run(testing::sphere, unit_cube(2), start, {.max_evaluations = 0}), std::invalid_argument);
    EXPECT_THROW(run(testing::sphere, unit_cube(2), start, {.relative_tolerance = 0}), std::invalid_argument);
    EXPECT_THROW(run(testing::sphere, unit_cube(2), start, {.max_seconds = -1}), std::invalid_argument);
}

TEST(Registry, NamesAreUniqueAndEntriesComplete) {
    std::set<std::string_view> names;
    for (const Optimiser& entry : optimisers()) {
        EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
        EXPECT_FALSE(entry.meaning.empty() || entry.source.empty()) << entry.name;
        EXPECT_EQ(&find_optimiser(entry.name), &entry);
    }
}

TEST(Registry, AnUnknownNameIsAnsweredWithTheKnownOnes) {
    try {
        minimise("lbgfs", testing::sphere, unit_cube(1), vector({0.5}));
        FAIL() << "an unknown optimiser was found";
    } catch (const std::invalid_argument& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("lbgfs"), std::string::npos) << text;
        for (const Optimiser& entry : optimisers())
            EXPECT_NE(text.find(entry.name), std::string::npos) << text;
    }
}

TEST(Options, SayFieldValueAndConstraint) {
    try {
        Options{.relative_tolerance = 2}.validate();
        FAIL() << "a tolerance of 2 was accepted";
    } catch (const std::invalid_argument& error) {
        EXPECT_STREQ(error.what(),
                     "optimizers: Options::relative_tolerance = 2, but it must be between 0 and 1");
    }
}

}  // namespace
}  // namespace loam::optimizers
