// Which line of a table is its header, which lines are rows, and which are neither.
#include "lab_data/csv_table.hpp"

#include <gtest/gtest.h>

#include "made_sample.hpp"

namespace loam::lab_data {
namespace {

std::optional<CsvTable> read(const std::string& text, Faults& faults) {
    const TemporaryFolder folder;
    folder.write("a.csv", text);
    return read_csv(folder.path() / "a.csv", faults);
}

TEST(ReadCsv, TakesAFailedFormulaInTheFirstCellForARow) {
    Faults faults;
    for (const char* text :
         {"# exported, then edited\na,b\n1,0\n#DIV/0!,0.01\n# thrice, in all, so\n2,0.02\n",
          "a;b;\n\n1;0;\n #DIV/0!;0.01;;\n# a remark\n2;0.02;\n",
          "# exported\na\tb\n1\t0\n#DIV/0!\t0.01\t\n#\n2\t0.02\n"}) {
        const auto table = read(text, faults);
        ASSERT_TRUE(table) << text;
        ASSERT_EQ(table->rows.size(), 3u) << text;
        EXPECT_EQ(table->rows[1].line, 4) << text;
        EXPECT_EQ(table->rows[1].cells, (std::vector<std::string>{"#DIV/0!", "0.01"})) << text;
    }
}

TEST(ReadCsv, CallsATitleAboveTheHeaderOne) {
    struct Title {
        const char* text;
        int line;
        const char *value, *remedy;
    };
    const char* const remove = "remove the lines above the header or begin them with #";
    for (const Title& title : {Title{"Oedometer test 12\na,b,c\n1,2,3\n", 1, "Oedometer test 12", remove},
                               {"Oedometer, Brno\n\na,b,c\n1,2,3\n", 1, "Oedometer", remove},
                               {"\nOedometer\n7 May 2024\na;b\n10;0\n20;0,4\n", 2, "Oedometer", remove},
                               {"sep=;\na;b\n10;0\n", 1, "sep=", remove},
                               {"Samples\nsample,file\nA,a.csv\n", 1, "Samples", remove},
                               {"Oedometer\n10,0\n20,0.004\n", 1, "Oedometer", "a name for each column"}}) {
        Faults faults;
        EXPECT_FALSE(read(title.text, faults));
        ASSERT_EQ(faults.errors.size(), 1u) << title.text;
        const UserError& error = faults.errors[0];
        EXPECT_EQ(error.line(), title.line) << title.text;
        EXPECT_EQ(error.value(), title.value);
        EXPECT_NE(error.constraint().find("is not a row of column names"), std::string::npos);
        EXPECT_NE(error.remedy().find(title.remedy), std::string::npos) << error.what();
    }
}

TEST(ReadCsv, TakesAHeaderForOneThoughRowsAreLonger) {
    Faults faults;
    EXPECT_TRUE(read("sample,file\nA,a.csv,\nB,b.csv,\n", faults));
    EXPECT_FALSE(read("sample,file\nA,sand,a.csv\nB,clay,b.csv\n", faults));
    ASSERT_EQ(faults.errors.size(), 2u);
    EXPECT_EQ(faults.errors[0].line(), 2);
    EXPECT_EQ(faults.errors[0].constraint(), "has 3 cells where the header names 2 columns");
}

}  // namespace
}  // namespace loam::lab_data
