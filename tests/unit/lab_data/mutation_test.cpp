// Randomly spoilt files: each is read or refused with a complete UserError. Nothing else may happen.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "lab_data/check.hpp"
#include "lab_data/data_set.hpp"
#include "lab_data/sample.hpp"
#include "made_sample.hpp"

namespace loam::lab_data {
namespace {

class Mutator {
  public:
    explicit Mutator(std::uint64_t seed) : random_(seed) {}

    std::size_t below(std::size_t bound) { return static_cast<std::size_t>(random_() % bound); }

    void mutate(std::string& text) {
        static const std::vector<std::string> tokens{",",          ";",
                                                     "\"",         "'",
                                                     "\n",         "\r",
                                                     "\t",         "-",
                                                     "1e309",      "nan",
                                                     "[[test]]\n", "[",
                                                     "{",          "}",
                                                     "=",          "#",
                                                     "_kPa",       "0,5",
                                                     "..",         "\\u0000",
                                                     "\"\"\"",     std::string(1, '\0'),
                                                     "\xff",       "\xef\xbb\xbf",
                                                     "a.a.a.a",    "99999999999999999999"};
        const std::size_t at = text.empty() ? 0 : below(text.size());
        switch (text.empty() ? 1 : below(6)) {
            case 0:
                text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
                break;
            case 1:
                text.insert(at, tokens[below(tokens.size())]);
                break;
            case 2:
                text.erase(at, 1 + below(8));
                break;
            case 3:
                text.resize(at);
                break;
            case 4:
                text.insert(at, text.substr(below(text.size()), 1 + below(40)));
                break;
            default:
                swap_lines(text);
        }
    }

  private:
    void swap_lines(std::string& text) {
        std::vector<std::string> lines;
        std::istringstream stream(text);
        for (std::string line; std::getline(stream, line);) lines.push_back(line);
        if (lines.empty()) return;
        std::swap(lines[below(lines.size())], lines[below(lines.size())]);
        text.clear();
        for (const std::string& line : lines) text += line + "\n";
    }

    std::mt19937_64 random_;
};

void expect_complete(const UserError& error) {
    EXPECT_FALSE(error.file().empty()) << error.what();
    EXPECT_FALSE(error.constraint().empty()) << error.what();
    EXPECT_FALSE(error.remedy().empty()) << error.what();
}

void expect_complete(const lab_data::Test& test) {
    EXPECT_GE(test.size(), 2u);
    EXPECT_GE(test.columns.size(), 2u);
    for (const auto& [name, values] : test.columns) {
        EXPECT_EQ(values.size(), test.size()) << name;
        for (const double value : values) EXPECT_TRUE(std::isfinite(value)) << name;
    }
    EXPECT_TRUE(test.phase.empty() || test.phase.size() == test.size());
    EXPECT_TRUE(test.kind != TestKind::oedometer || seating_stress(test) > 0);
}

void expect_complete(const Sample& sample) {
    EXPECT_FALSE(sample.name.empty());
    EXPECT_GT(sample.grain_density, 0);
    EXPECT_FALSE(sample.tests.empty());
    for (const lab_data::Test& test : sample.tests) expect_complete(test);
}

/// Spoils one file at a time, reads, and mends it. Gives how often the files could be read.
template <class Read>
int spoil(const Files& sound, int rounds, std::uint64_t seed, Read read_and_inspect) {
    const TemporaryFolder folder;
    write_all(folder, sound);
    Mutator mutator(seed);
    int read = 0;
    for (int round = 0; round < rounds; ++round) {
        auto file = sound.begin();
        std::advance(file, static_cast<long>(mutator.below(sound.size())));
        std::string text = file->second;
        for (std::size_t count = 1 + mutator.below(2); count > 0; --count) mutator.mutate(text);
        folder.write(file->first, text);
        try {
            read_and_inspect(folder.path());
            ++read;
        } catch (const UserError& error) {
            expect_complete(error);
            EXPECT_FALSE(check(folder.path()).sound());
        }
        folder.write(file->first, file->second);
    }
    return read;
}

// Both outcomes must happen, or the mutations are too tame or too wild to test anything.

TEST(Mutations, SamplesAreReadOrRefusedInFull) {
    const int read =
        spoil(sound_files(), 2000, 20240611, [](const auto& path) { expect_complete(read_sample(path)); });
    EXPECT_GT(read, 100);
    EXPECT_LT(read, 1900);
}

TEST(Mutations, DataSetsAreReadOrRefusedInFull) {
    const Files sound{
        {"dataset.toml",
         "name = \"d\"\nkind = \"oedometer\"\nsource = \"s\"\nlicence = \"l\"\nseating_stress_kPa = 2\n"},
        {"samples.csv", "sample,file,initial_void_ratio,depth_m\nA,a.csv,0.8,1\nB,b.csv,,2\n"},
        {"a.csv", "axial_stress_kPa,axial_strain\n15,0.001\n29,0.002\n57,0.004\n"},
        {"b.csv",
         "phase,axial_stress_kPa,axial_strain_percent\nloading,15,0.1\nloading,29,0.2\nunloading,15,0.2\n"}};
    const int read = spoil(sound, 1000, 5, [](const auto& path) {
        const DataSet set = read_data_set(path);
        EXPECT_FALSE(set.rows.empty());
        for (const DataSetRow& row : set.rows) {
            EXPECT_EQ(row.covariates.size(), set.covariates.size());
            if (row.readable())
                expect_complete(std::get<lab_data::Test>(row.test));
            else
                expect_complete(std::get<UserError>(row.test));
        }
    });
    EXPECT_GT(read, 100);
    EXPECT_LT(read, 900);
}

}  // namespace
}  // namespace loam::lab_data
