// Running an ensemble: each run once, results independent of workers and order, failures stored with reasons.
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <new>
#include <set>
#include <thread>

#include "experiments/ensemble/ensemble.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/output/atomic_file.hpp"
#include "tests/unit/experiments/store_helpers.hpp"

namespace loam::experiments {
namespace {

using namespace testing;

RunRecord quick_run(const RunSpec& spec, const StopToken&) {
    return toy_run(spec);
}

TEST(RunSeed, SplitMixGivesThePublishedSequence) {
    // Seed 1234567, the sequence of the reference implementation (S. Vigna, splitmix64.c) as on Rosetta Code.
    const std::uint64_t published[] = {6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
                                       4593380528125082431u, 16408922859458223821u};
    for (std::uint64_t n = 0; n < 5; ++n)
        EXPECT_EQ(splitmix64(1234567u + n * 0x9e3779b97f4a7c15u), published[n]);
}

TEST(RunSeed, DiffersByCampaignIndexAndStreamAndLooksRandom) {
    std::set<std::uint64_t> seen;
    double bits = 0;
    for (std::uint64_t campaign = 0; campaign < 20; ++campaign)
        for (std::uint64_t stream = 0; stream < 5; ++stream)
            for (std::uint64_t index = 0; index < 200; ++index) {
                const std::uint64_t seed = run_seed(campaign, index, stream);
                EXPECT_TRUE(seen.insert(seed).second);
                bits += __builtin_popcountll(seed ^ run_seed(campaign, index + 1, stream));
            }
    // Neighbours differ in half of their 64 bits: mean 32, standard deviation of the mean 4 / sqrt(20000).
    EXPECT_NEAR(bits / 20000, 32, 0.15);
}

TEST(Ensemble, MakesEachRunOnceAndReturnsThemInTheOrderAsked) {
    const TemporaryFolder folder;
    EnsembleStore store(folder.path(), toy_header());
    std::vector<RunSpec> specs = toy_specs(30);
    std::reverse(specs.begin(), specs.end());
    std::atomic<int> calls{0};
    const RunFunction run = [&](const RunSpec& spec, const StopToken&) {
        ++calls;
        return toy_run(spec);
    };
    const EnsembleSummary first = run_ensemble(store, std::span(specs).subspan(10), run, {.jobs = 2});
    EXPECT_EQ(calls, 20);
    EXPECT_EQ(first.executed, 20u);
    EXPECT_EQ(first.reused, 0u);
    EXPECT_EQ(first.failed, 2u);  // 6 and 13 of 0..19
    const EnsembleSummary second = run_ensemble(store, specs, run, {.jobs = 2});
    EXPECT_EQ(calls, 30);
    EXPECT_EQ(second.executed, 10u);
    EXPECT_EQ(second.reused, 20u);
    EXPECT_EQ(second.failed, 4u);  // and 20, 27
    ASSERT_EQ(second.records.size(), 30u);
    for (std::size_t i = 0; i < specs.size(); ++i) {
        RunRecord expected = toy_run(specs[i]);
        EXPECT_TRUE(same_record(second.records[i], expected)) << i;
    }
    EXPECT_TRUE(run_ensemble(store, {}, run).records.empty());
}

TEST(Ensemble, TheFileIsTheSameBitsForAnyNumberOfWorkersAndAnyDurations) {
    std::vector<std::string> files;
    for (const int jobs : {1, 2, 7}) {
        const TemporaryFolder folder;
        EnsembleStore store(folder.path(), toy_header());
        const RunFunction run = [&](const RunSpec& spec, const StopToken&) {
            std::this_thread::sleep_for(
                std::chrono::microseconds(splitmix64(spec.index + 100u * jobs) % 3000));
            return toy_run(spec);
        };
        (void)run_ensemble(store, toy_specs(40), run, {.jobs = jobs});
        files.push_back(read_whole_file(store.file()));
    }
    EXPECT_EQ(files[0], files[1]);
    EXPECT_EQ(files[0], files[2]);
}

TEST(Ensemble, WhateverGoesWrongInARunIsStoredWithItsReason) {
    const TemporaryFolder folder;
    EnsembleStore store(folder.path(), toy_header());
    const RunFunction run = [](const RunSpec& spec, const StopToken&) -> RunRecord {
        RunRecord record = toy_run(spec);
        switch (spec.index) {
            case 1:
                throw std::runtime_error("the packing\nexploded");
            case 2:
                throw 5;
            case 3:
                record.outputs[1] = std::numeric_limits<double>::quiet_NaN();
                break;
            case 4:
                record.ok = false;
                break;  // outputs and no reason
            case 5:
                throw std::runtime_error(std::string(999, 'x') + "µm");
            default:
                break;
        }
        return record;
    };
    (void)run_ensemble(store, toy_specs(6), run, {.jobs = 2});
    const std::vector<RunRecord> records = load_ensemble(folder.path()).records;
    EXPECT_TRUE(records[0].ok);
    EXPECT_EQ(records[1].reason, "the packing exploded");
    EXPECT_EQ(records[2].reason, "the run threw something that is not an exception");
    EXPECT_EQ(records[3].reason, "an output is not a finite number");
    EXPECT_EQ(records[4].reason, "no reason given");
    EXPECT_EQ(records[5].reason, std::string(999, 'x'));  // cut before the character that would be split
    for (std::size_t i = 1; i < 6; ++i) {
        EXPECT_FALSE(records[i].ok);
        EXPECT_EQ(records[i].outputs.size(), 0);
        EXPECT_TRUE(same_record(store.find(i).value(), records[i]));
    }
    EXPECT_TRUE(std::isnan(records[1].diagnostics[0]));
    EXPECT_EQ(records[3].diagnostics[1], 0.4);
}

TEST(Ensemble, LackOfMemoryAndResultsThatDoNotFitEndItAndKeepTheRest) {
    for (const bool memory : {true, false}) {
        const TemporaryFolder folder;
        EnsembleStore store(folder.path(), toy_header());
        const RunFunction run = [&](const RunSpec& spec, const StopToken&) {
            if (spec.index == 5 && memory) throw std::bad_alloc();
            RunRecord record = toy_run(spec);
            if (spec.index == 5) record.outputs.conservativeResize(1);
            return record;
        };
        if (memory)
            EXPECT_THROW((void)run_ensemble(store, toy_specs(10), run, {.jobs = 1}), std::bad_alloc);
        else
            EXPECT_THROW((void)run_ensemble(store, toy_specs(10), run, {.jobs = 1}), std::invalid_argument);
        EXPECT_EQ(store.size(), 5u);
        EXPECT_EQ(load_ensemble(folder.path()).records.size(), 5u);
    }
}

TEST(Ensemble, ARunStoredWithOtherInputsBelongsToAnotherCampaign) {
    const TemporaryFolder folder;
    EnsembleStore store(folder.path(), toy_header());
    const std::vector<RunSpec> specs = toy_specs(4);
    (void)run_ensemble(store, specs, quick_run);
    const auto expect_refused = [&](const std::function<void(RunSpec&)>& change) {
        std::vector<RunSpec> other = specs;
        change(other[2]);
        const std::string text = error_of([&] { (void)run_ensemble(store, other, quick_run); });
        EXPECT_NE(text.find("ensemble.h5: belongs to another campaign: run 2 was made with other parameters"),
                  std::string::npos)
            << text;
    };
    expect_refused([](auto& spec) { spec.parameters[1] += 1e-15; });
    expect_refused([](auto& spec) { spec.packing_seed = 0; });
    expect_refused([](auto& spec) { spec.particles = 701; });
    expect_refused([](auto& spec) { spec.purpose = "confirmation"; });
}

TEST(Ensemble, MistakesOfTheCallerAreRefused) {
    const TemporaryFolder folder;
    EnsembleStore store(folder.path(), toy_header());
    std::vector<RunSpec> specs = toy_specs(3);
    EXPECT_THROW((void)run_ensemble(store, specs, quick_run, {.jobs = -1}), std::invalid_argument);
    EXPECT_THROW((void)run_ensemble(store, specs, quick_run, {.seconds_between_progress = 0}),
                 std::invalid_argument);
    specs[2].index = 0;
    EXPECT_THROW((void)run_ensemble(store, specs, quick_run), std::invalid_argument);
    EXPECT_EQ(store.size(), 0u);
}

TEST(Ensemble, ReportsFromTheCallingThread) {
    const TemporaryFolder folder;
    EnsembleStore store(folder.path(), toy_header());
    (void)run_ensemble(store, toy_specs(5), quick_run);
    const auto caller = std::this_thread::get_id();
    EnsembleProgress last;
    std::set<std::uint64_t> recorded;
    EnsembleOptions options{.jobs = 2, .seconds_between_progress = 0.001};
    options.on_progress = [&](const EnsembleProgress& progress) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        EXPECT_GE(progress.executed, last.executed);
        last = progress;
    };
    options.on_record = [&](const RunRecord& record) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        EXPECT_TRUE(store.find(record.spec.index).has_value());
        EXPECT_TRUE(recorded.insert(record.spec.index).second);
    };
    (void)run_ensemble(store, toy_specs(20), quick_run, options);
    EXPECT_EQ(recorded.size(), 15u);
    EXPECT_EQ(*recorded.begin(), 5u);
    EXPECT_EQ(last.total, 20u);
    EXPECT_EQ(last.reused, 5u);
    EXPECT_EQ(last.executed, 15u);
    EXPECT_EQ(last.failed, 2u);
}

TEST(Ensemble, AnErrorWhileReportingStopsTheWorkers) {
    const TemporaryFolder folder;
    EnsembleStore store(folder.path(), toy_header());
    EnsembleOptions options{.jobs = 2, .seconds_between_progress = 0.001};
    options.on_record = [](const RunRecord&) { throw std::runtime_error("the caller's own trouble"); };
    const RunFunction run = [](const RunSpec& spec, const StopToken& stop) {
        // Only the first run ends by itself.
        while (spec.index > 0) {
            stop.throw_if_requested();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return toy_run(spec);
    };
    EXPECT_THROW((void)run_ensemble(store, toy_specs(20), run, options), std::runtime_error);
    EXPECT_EQ(store.size(), 1u);
}

}  // namespace
}  // namespace loam::experiments
