#include <gtest/gtest.h>

#include <array>
#include <string>

#include "lab_data/nearest_name.hpp"
#include "lab_data/number.hpp"
#include "lab_data/user_error.hpp"
#include "lab_data/utf8.hpp"

namespace loam::lab_data {
namespace {

TEST(EditDistance, CountsTheLeastEdits) {
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);  // Levenshtein's textbook case
    EXPECT_EQ(edit_distance("", "abc"), 3u);
    EXPECT_EQ(edit_distance("abc", ""), 3u);
    EXPECT_EQ(edit_distance("strian", "strain"), 1u);  // one swap of neighbours
    EXPECT_EQ(edit_distance("ca", "abc"), 3u);         // optimal string alignment, not full Damerau (2)
    EXPECT_EQ(edit_distance("phase", "phase"), 0u);
}

constexpr std::array<std::string_view, 4> names{"axial_stress_kPa", "axial_strain", "phase", "void_ratio"};

TEST(NearestName, FindsWhatWasMeant) {
    EXPECT_EQ(nearest_name("axial_strian", names), "axial_strain");
    EXPECT_EQ(nearest_name("Axial-Stress kpa", names), "axial_stress_kPa");
    EXPECT_EQ(nearest_name("phase", names), "phase");
}

TEST(NearestName, GivesNothingForWhatIsTooFar) {
    EXPECT_EQ(nearest_name("temperature", names), std::nullopt);
    EXPECT_EQ(nearest_name("p", names), std::nullopt);
    EXPECT_EQ(nearest_name("", names), std::nullopt);
    EXPECT_EQ(nearest_name(std::string(100000, 'x'), names), std::nullopt);
    EXPECT_EQ(nearest_name("phase", {}), std::nullopt);
}

TEST(NearestName, SuggestsOneOrListsAll) {
    EXPECT_EQ(suggest_name("phse", names), "did you mean 'phase'?");
    EXPECT_EQ(suggest_name("xyz", std::array<std::string_view, 2>{"a", "b"}), "use one of a, b");
}

TEST(ParseNumber, ReadsDecimalNumbers) {
    EXPECT_EQ(parse_number("12.5"), 12.5);
    EXPECT_EQ(parse_number(" +3e2\t"), 300.0);
    EXPECT_EQ(parse_number("-0.5E-1"), -0.05);
    EXPECT_EQ(parse_number(".5"), 0.5);
    EXPECT_EQ(parse_number("5."), 5.0);
    EXPECT_EQ(parse_number("007"), 7.0);
}

TEST(ParseNumber, RefusesEverythingElse) {
    for (const char* text : {"",
                             " ",
                             "12,5",
                             "1 2",
                             "0x10",
                             "inf",
                             "-inf",
                             "nan",
                             "1e999",
                             "--1",
                             "+-1",
                             "1e",
                             "e5",
                             ".",
                             "-",
                             "+",
                             "5 kPa",
                             "5%",
                             "1.2.3",
                             "true",
                             "\xe2\x88\x92"
                             "5"})
        EXPECT_EQ(parse_number(text), std::nullopt) << text;
}

TEST(NumberRemedy, SaysWhatToWrite) {
    const auto has = [](const char* text, const char* words) {
        EXPECT_NE(number_remedy(text).find(words), std::string::npos) << text << ": " << number_remedy(text);
    };
    has("12,5", "write 12.5");
    has("1,234,567", "write 1234567");
    has("1 234", "write 1234");
    has("\xe2\x88\x92"
        "5",
        "write -5");
    has("5%", "_percent");
    has("5 kPa", "write 5");
    has("#DIV/0!", "spreadsheet");
    has("# stage 2", "above the header if it is a comment");
    has("n/a", "leave the whole row out");
    has("abc", "0.0125");
    has("0xB4", "0.0125");
    has("1e400", "0.0125");
}

TEST(NumberRemedy, NeverNamesAnotherNumber) {
    const std::string point = " with a decimal point, and no separators of thousands";
    const std::string thousands = " without separators of thousands";
    const std::string nothing = "write a number such as 0.0125";
    struct Remedy {
        const char* text;
        std::string words;
    };
    for (const Remedy& remedy : {
             Remedy{"1.234,5", "write 1234.5" + thousands},
             {"1,234.5", "write 1234.5" + thousands},
             {"1.234.567", "write 1234567" + thousands},
             {"-1,234", "write -1234" + thousands + ", or -1.234 if the comma is a decimal one"},
             {"0,125", "write 0.125" + point},
             {"12,5%", "write 12.5" + point + ", leave out the percent sign and end the name with _percent"},
             {"0,5 %", "write 0.5" + point + ", leave out the percent sign and end the name with _percent"},
             {"5 %", "write 5 alone, leave out the percent sign and end the name with _percent"},
             {"5,0 kPa", "write 5.0" + point + ", alone if 'kPa' is a unit, which belongs in the name"},
             {"5\xc2\xa0kPa", "write 5 alone if 'kPa' is a unit, which belongs in the name"},
             {"20 \xc2\xb0", "write 20 alone if '\xc2\xb0' is a unit, which belongs in the name"},
             {"1 200 kPa",
              "write 1200" + thousands + ", alone if 'kPa' is a unit, which belongs in the name"},
             {"3e5 Pa", "write 3e5 alone if 'Pa' is a unit, which belongs in the name"},
             {"1\xc2\xa0"
              "200",
              "write 1200" + thousands},
             {"1\xe2\x80\xaf"
              "200,5",
              "write 1200.5" + thousands},
             {"1\xe2\x80\x89"
              "200",
              "write 1200" + thousands},
             {"1'200", "write 1200" + thousands},
             {"1\xe2\x80\x99"
              "200.25",
              "write 1200.25" + thousands},
             {"1_000", "write 1000" + thousands},
             {"1,5e3", "write 1.5e3" + point},
             {"1,2,3", nothing},
             {"1 2", nothing},
             {"10 20 30", nothing},
             {"1.2.3", nothing},
             {"1,23,456", nothing},
             {"1/2", nothing},
             {"1D3", nothing},
             {"1d+3", nothing},
             {"0x1F", nothing},
             {"5 6 kPa", nothing},
             {"2024-01-02", nothing},
         })
        EXPECT_EQ(number_remedy(remedy.text), remedy.words) << remedy.text;
}

TEST(UserError, PutsTheMessageTogether) {
    const UserError error({.file = "x/oedometer.csv",
                           .line = 7,
                           .column = "axial_strain",
                           .value = "12,5",
                           .constraint = "must be a number",
                           .remedy = "write 12.5"});
    EXPECT_STREQ(error.what(),
                 "x/oedometer.csv:7: column 'axial_strain': value '12,5' must be a number; write 12.5");
    EXPECT_EQ(error.line(), 7);
    EXPECT_EQ(error.remedy(), "write 12.5");
    const UserError missing({.file = "sample.toml", .column = "name", .constraint = "is missing"});
    EXPECT_STREQ(missing.what(), "sample.toml: key 'name' is missing");
    const UserError option({.column = "--runs", .value = "-1", .constraint = "must be positive"});
    EXPECT_STREQ(option.what(), "option '--runs': value '-1' must be positive");
}

TEST(UserError, ShowsHostileValuesHarmlessly) {
    const UserError error({.value = "\x1b[31m" + std::string(1000, 'x'), .constraint = "is odd"});
    const std::string text = error.what();
    EXPECT_NE(text.find("\\x1b[31m"), std::string::npos);
    EXPECT_LT(text.size(), 120u);
    EXPECT_STREQ(UserError({.value = "caf\xe9", .constraint = "is odd"}).what(), "value 'caf\\xe9' is odd");
    const std::string accents =
        UserError({.value = std::string(59, 'x') + "\xc3\xa9y", .constraint = "is odd"}).what();
    EXPECT_NE(accents.find("x\xc3\xa9...'"), std::string::npos);  // cut between characters, not inside one
}

TEST(Utf8, KnowsWellFormedCharacters) {
    EXPECT_EQ(utf8_character_length("a"), 1u);
    EXPECT_EQ(utf8_character_length("\xc3\xa9"), 2u);  // U+00E9
    EXPECT_EQ(utf8_character_length("\xe2\x88\x92"
                                    "5"),
              3u);                                             // U+2212
    EXPECT_EQ(utf8_character_length("\xf0\x9f\x98\x80"), 4u);  // U+1F600
    for (const char* text : {"", "\x80", "\xc0\xaf", "\xc3", "\xc3(", "\xe0\x80\x80", "\xed\xa0\x80",
                             "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff"})
        EXPECT_EQ(utf8_character_length(text), 0u);
}

}  // namespace
}  // namespace loam::lab_data
