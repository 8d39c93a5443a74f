// The store over both its files: nothing is lost, whatever state a kill, a power cut or a user leaves.
#include <gtest/gtest.h>

#include <csignal>
#include <limits>
#include <random>

#include "experiments/output/atomic_file.hpp"
#include "experiments/store/ensemble_store.hpp"
#include "tests/unit/experiments/store_helpers.hpp"

namespace loam::experiments {
namespace {

using namespace testing;

TEST(Store, KeepsWhatIsAppendedAndWritesTheSameBitsInAnyOrder) {
    const auto records = toy_contents(30).records;
    std::vector<std::string> files;
    for (unsigned order = 0; order < 3; ++order) {
        const TemporaryFolder folder;
        auto shuffled = records;
        std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937_64(order));
        {
            EnsembleStore store(folder.path(), toy_header());
            for (std::size_t i = 0; i < shuffled.size(); ++i) {
                store.append(shuffled[i]);
                if (order > 0 && i % (7 * order) == 3) store.checkpoint();
            }
            store.checkpoint();
            expect_same(store.records(), records);
            EXPECT_TRUE(same_record(store.find(6).value(), records[6]));
            EXPECT_FALSE(store.find(30).has_value());
        }
        EXPECT_EQ(files_in(folder.path()), (std::vector<std::string>{".lock", "ensemble.h5"}));
        expect_same(load_ensemble(folder.path()).records, records);
        files.push_back(read_whole_file(folder.path() / "ensemble.h5"));
    }
    EXPECT_EQ(files[0], files[1]);
    EXPECT_EQ(files[0], files[2]);
}

TEST(Store, WithoutACheckpointTheJournalKeepsTheRuns) {
    const TemporaryFolder folder;
    const auto records = toy_contents(5).records;
    {
        EnsembleStore store(folder.path(), toy_header());
        for (const RunRecord& record : records) store.append(record);
    }
    // A reader sees them, and changes nothing.
    expect_same(load_ensemble(folder.path()).records, records);
    EXPECT_EQ(files_in(folder.path()),
              (std::vector<std::string>{".lock", "ensemble.h5", "ensemble.journal"}));
    EnsembleStore store(folder.path(), toy_header());
    EXPECT_EQ(store.recovery().journal_records, 5u);
    EXPECT_EQ(store.recovery().damaged_bytes, 0u);
    expect_same(store.records(), records);
    EXPECT_EQ(files_in(folder.path()), (std::vector<std::string>{".lock", "ensemble.h5"}));
}

TEST(Store, SurvivesEveryStateThatAKillOrAPowerCutLeaves) {
    const auto records = toy_contents(6).records;
    const std::vector<RunRecord> early(records.begin(), records.begin() + 4);
    const std::string old_h5 = encode_ensemble({toy_header(), early});
    const std::string new_h5 = encode_ensemble({toy_header(), records});
    const std::string journal = journal_of({records[4], records[5]}, toy_header());
    struct State {
        std::string name, h5, journal, temporary;
    };
    const std::vector<State> states{
        {"before the checkpoint", old_h5, journal, ""},
        {"half of ensemble.h5.tmp written", old_h5, journal, new_h5.substr(0, new_h5.size() / 2)},
        {"ensemble.h5.tmp written, not renamed", old_h5, journal, new_h5},
        {"renamed, journal still there", new_h5, journal, ""},
        {"journal removed", new_h5, "", ""},
        {"ensemble.h5 lost by hand, all runs in the journal", "", journal_of(records, toy_header()), ""},
    };
    for (const State& state : states) {
        const TemporaryFolder folder;
        const auto put = [&](const char* name, const std::string& bytes) {
            if (!bytes.empty()) write_file_atomically(folder.path() / name, bytes);
        };
        put("ensemble.h5", state.h5);
        put("ensemble.journal", state.journal);
        put("ensemble.h5.tmp", state.temporary);
        if (!state.h5.empty()) expect_same(load_ensemble(folder.path()).records, records);
        EnsembleStore store(folder.path(), toy_header());
        expect_same(store.records(), records);
        store.checkpoint();
        EXPECT_EQ(read_whole_file(folder.path() / "ensemble.h5"), new_h5) << state.name;
        EXPECT_FALSE(std::filesystem::exists(folder.path() / "ensemble.journal")) << state.name;
    }
}

TEST(Store, ADamagedJournalCostsOnlyTheDamagedRunsAndSaysSo) {
    const TemporaryFolder folder;
    const auto records = toy_contents(3).records;
    std::string journal = journal_of(records, toy_header());
    journal[journal.size() / 2] =
        static_cast<char>(journal[journal.size() / 2] ^ 1);  // in the second of three
    write_file_atomically(folder.path() / "ensemble.journal", journal);
    EnsembleStore store(folder.path(), toy_header());
    EXPECT_EQ(store.recovery().journal_records, 2u);
    EXPECT_GT(store.recovery().damaged_bytes, 0u);
    EXPECT_FALSE(store.find(1).has_value());
    store.append(records[1]);
    expect_same(store.records(), records);
}

TEST(Store, AnotherCampaignsFolderIsRefusedAndLeftAlone) {
    const TemporaryFolder folder;
    {
        EnsembleStore store(folder.path(), toy_header());
        store.append(toy_run(toy_spec(0)));
        store.checkpoint();
    }
    const std::string before = read_whole_file(folder.path() / "ensemble.h5");
    EnsembleHeader other = toy_header();
    other.campaign_seed = 43;
    other.parameters[1].upper = 0.7;
    other.outputs.pop_back();
    other.attributes["law"] = "linear-damped";
    const std::string text = error_of([&] { EnsembleStore(folder.path(), other); });
    EXPECT_NE(
        text.find("ensemble.h5: belongs to another campaign: the campaign seed is 42 there and 43 here; "
                  "parameter 2 is 'friction_angle from 0.05 to 0.8 rad' there"),
        std::string::npos)
        << text;
    EXPECT_NE(text.find("and 1 more"), std::string::npos) << text;
    EXPECT_NE(text.find("choose another folder with --out, or delete"), std::string::npos) << text;
    EXPECT_EQ(read_whole_file(folder.path() / "ensemble.h5"), before);
    EXPECT_EQ(EnsembleStore(folder.path(), toy_header()).size(), 1u);
}

TEST(Store, AJournalOfAnotherCampaignIsRefusedAndLeftAlone) {
    const TemporaryFolder folder;
    EnsembleHeader other = toy_header();
    other.campaign_seed = 43;
    const std::string journal = journal_of(toy_contents(2).records, other);
    write_file_atomically(folder.path() / "ensemble.journal", journal);
    const std::string text = error_of([&] { EnsembleStore(folder.path(), toy_header()); });
    EXPECT_NE(text.find("ensemble.journal: belongs to another campaign"), std::string::npos) << text;
    EXPECT_EQ(read_whole_file(folder.path() / "ensemble.journal"), journal);
}

TEST(Store, ARunThatDiffersBetweenFileAndJournalIsRefused) {
    const TemporaryFolder folder;
    auto records = toy_contents(2).records;
    write_file_atomically(folder.path() / "ensemble.h5", encode_ensemble({toy_header(), records}));
    records[1].outputs[0] += 1e-12;
    write_file_atomically(folder.path() / "ensemble.journal", journal_of({records[1]}, toy_header()));
    EXPECT_NE(error_of([&] { EnsembleStore(folder.path(), toy_header()); }).find("run 1 differs"),
              std::string::npos);
    EXPECT_NE(error_of([&] { load_ensemble(folder.path()); }).find("run 1 differs"), std::string::npos);
}

TEST(Store, ADamagedFileIsAnErrorNotANewBeginning) {
    const TemporaryFolder folder;
    const std::string damaged = encode_ensemble(toy_contents(4)).substr(0, 3000);
    write_file_atomically(folder.path() / "ensemble.h5", damaged);
    EXPECT_NE(error_of([&] { EnsembleStore(folder.path(), toy_header()); }).find("is damaged"),
              std::string::npos);
    EXPECT_NE(error_of([&] { load_ensemble(folder.path()); }).find("is damaged"), std::string::npos);
    EXPECT_EQ(read_whole_file(folder.path() / "ensemble.h5"), damaged);
}

TEST(Store, LoadingWhereNothingIsNamesTheFile) {
    const TemporaryFolder folder;
    const std::string text = error_of([&] { load_ensemble(folder.path()); });
    EXPECT_NE(text.find("ensemble.h5: cannot be read: No such file"), std::string::npos) << text;
}

TEST(Store, ASecondProcessIsTurnedAway) {
    const TemporaryFolder folder;
    const EnsembleStore store(folder.path(), toy_header());
    const int status = wait_for(start_child([&] {
        const std::string text = error_of([&] { EnsembleStore(folder.path(), toy_header()); });
        return text.find("is in use: another process is working in this folder") != std::string::npos ? 7 : 1;
    }));
    EXPECT_EQ(status, 7);
}

TEST(Store, AKilledProcessLeavesNoLock) {
    const TemporaryFolder folder;
    const int status = wait_for(start_child([&]() -> int {
        const EnsembleStore store(folder.path(), toy_header());
        ::raise(SIGKILL);
        return 0;
    }));
    EXPECT_EQ(status, -SIGKILL);
    EXPECT_NO_THROW(EnsembleStore(folder.path(), toy_header()));
}

TEST(Store, RecordsThatDoNotFitAreRefused) {
    const TemporaryFolder folder;
    EnsembleStore store(folder.path(), toy_header());
    const auto refused = [&](const std::function<void(RunRecord&)>& change) {
        RunRecord record = toy_run(toy_spec(1));
        change(record);
        EXPECT_THROW(store.append(record), std::invalid_argument);
    };
    refused([](auto& r) { r.outputs.conservativeResize(2); });
    refused([](auto& r) { r.outputs[0] = std::nan(""); });
    refused([](auto& r) { r.spec.parameters[1] = std::numeric_limits<double>::infinity(); });
    refused([](auto& r) { r.spec.parameters.conservativeResize(1); });
    refused([](auto& r) { r.diagnostics.resize(1); });
    refused([](auto& r) { r.spec.purpose = ""; });
    refused([](auto& r) { r.reason = "ok, but"; });
    refused([](auto& r) { r.ok = false; });
    refused([](auto& r) { r.ok = false, r.reason = "failed with outputs"; });
    EXPECT_EQ(store.size(), 0u);
    store.append(toy_run(toy_spec(1)));
    refused([](auto&) {});  // there already
    EXPECT_THROW((StoreOptions{.checkpoint_seconds = 0}.validate()), std::invalid_argument);
}

TEST(Store, MakesCheckpointsByItself) {
    const TemporaryFolder folder;
    EnsembleStore store(folder.path(), toy_header(), {.checkpoint_seconds = 1e-9});
    store.append(toy_run(toy_spec(1)));
    EXPECT_EQ(decode_ensemble(read_whole_file(store.file()), store.file()).records.size(), 1u);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "ensemble.journal"));
}

}  // namespace
}  // namespace loam::experiments
