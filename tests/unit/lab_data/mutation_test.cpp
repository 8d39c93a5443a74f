// Randomly spoilt files: each is read or refused with a complete UserError. Nothing else may happen.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "lab_data/check.hpp"
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

void expect_complete(const Sample& sample) {
    EXPECT_FALSE(sample.name.empty());
    EXPECT_GT(sample.grain_density, 0);
    ASSERT_FALSE(sample.tests.empty());
    for (const lab_data::Test& test : sample.tests) {
        EXPECT_GE(test.size(), 2u);
        EXPECT_GE(test.columns.size(), 2u);
        for (const auto& [name, values] : test.columns) {
            EXPECT_EQ(values.size(), test.size()) << name;
            for (const double value : values) EXPECT_TRUE(std::isfinite(value)) << name;
        }
        EXPECT_TRUE(test.phase.empty() || test.phase.size() == test.size());
        EXPECT_TRUE(test.kind != TestKind::oedometer || seating_stress(test) > 0);
    }
}

TEST(Mutations, AreReadOrRefusedInFull) {
    const Files sound = sound_files();
    const TemporaryFolder folder;
    write_all(folder, sound);
    Mutator mutator(20240611);
    int read = 0, refused = 0;
    for (int round = 0; round < 2000; ++round) {
        auto file = sound.begin();
        std::advance(file, static_cast<long>(mutator.below(sound.size())));
        std::string text = file->second;
        for (std::size_t count = 1 + mutator.below(2); count > 0; --count) mutator.mutate(text);
        folder.write(file->first, text);
        try {
            expect_complete(read_sample(folder.path()));
            ++read;
        } catch (const UserError& error) {
            EXPECT_FALSE(error.file().empty()) << error.what();
            EXPECT_FALSE(error.constraint().empty()) << error.what();
            EXPECT_FALSE(error.remedy().empty()) << error.what();
            EXPECT_FALSE(check(folder.path()).sound());
            ++refused;
        }
        folder.write(file->first, file->second);
    }
    // Both must happen, or the mutations are too tame or too wild to test anything.
    EXPECT_GT(read, 100);
    EXPECT_GT(refused, 200);
}

}  // namespace
}  // namespace loam::lab_data
