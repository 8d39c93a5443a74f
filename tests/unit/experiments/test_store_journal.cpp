// The journal: whole records are read again, torn and damaged ones are recognised, foreign ones refused.
#include <gtest/gtest.h>

#include <random>

#include "tests/unit/experiments/store_helpers.hpp"

namespace loam::experiments {
namespace {

using namespace testing;

TEST(Journal, IsReadAsItWasWritten) {
    const auto records = toy_contents(20).records;
    const auto read = parse_journal(journal_of(records, toy_header()), fingerprint(toy_header()));
    EXPECT_EQ(read.damaged_bytes, 0u);
    EXPECT_FALSE(read.foreign);
    expect_same(read.records, records);
    EXPECT_TRUE(parse_journal("", fingerprint(toy_header())).records.empty());
}

TEST(Journal, ATornTailOfAnyLengthCostsTheLastRunAlone) {
    const auto records = toy_contents(3).records;
    const std::string two = journal_of({records[0], records[1]}, toy_header());
    const std::string three = journal_of(records, toy_header());
    for (std::size_t size = two.size(); size < three.size(); ++size) {
        const auto read = parse_journal(three.substr(0, size), fingerprint(toy_header()));
        ASSERT_EQ(read.records.size(), 2u) << size;
        EXPECT_EQ(read.damaged_bytes, size - two.size());
    }
    for (std::size_t size = 0; size < two.size(); ++size)
        EXPECT_LE(parse_journal(three.substr(0, size), fingerprint(toy_header())).records.size(), 1u);
}

TEST(Journal, AFlippedByteCostsAtMostTheRunItIsIn) {
    const auto records = toy_contents(3).records;
    const std::string bytes = journal_of(records, toy_header());
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ 0x41);
        const auto read = parse_journal(changed, fingerprint(toy_header()));
        ASSERT_GE(read.records.size(), 2u) << "byte " << at;
        EXPECT_GT(read.damaged_bytes, 0u) << "byte " << at;
        for (const RunRecord& record : read.records)
            EXPECT_TRUE(same_record(record, records[record.spec.index])) << "byte " << at;
    }
}

TEST(Journal, NoiseIsNeverTakenForARun) {
    std::mt19937_64 random(7);
    const std::string whole = journal_of(toy_contents(4).records, toy_header());
    for (int trial = 0; trial < 300; ++trial) {
        std::string noise = whole;
        // One byte in each sixteen: every record is hit.
        for (std::size_t block = 0; block + 16 <= noise.size(); block += 16) {
            char& byte = noise[block + random() % 16];
            byte = static_cast<char>(byte ^ static_cast<char>(1 + random() % 255));
        }
        EXPECT_TRUE(parse_journal(noise, fingerprint(toy_header())).records.empty());
    }
}

TEST(Journal, OfAnotherCampaignIsNotRead) {
    EnsembleHeader other = toy_header();
    other.campaign_seed = 1;
    const auto read = parse_journal(journal_of(toy_contents(2).records, other), fingerprint(toy_header()));
    EXPECT_TRUE(read.foreign);
    EXPECT_TRUE(read.records.empty());
}

}  // namespace
}  // namespace loam::experiments
