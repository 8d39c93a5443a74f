#include "lab_data/data_set.hpp"

#include <gtest/gtest.h>

#include "made_sample.hpp"

namespace loam::lab_data {
namespace {

Files sound_data_set() {
    return {{"dataset.toml",
             "name = \"three\"\nkind = \"oedometer\"\nsource = \"made up\"\nlicence = \"CC0-1.0\"\n"
             "attribution = \"nobody\"\nmeasured = false\nseating_stress_kPa = 2\n"},
            {"samples.csv",
             "sample,file,initial_void_ratio,texture,depth_cm,clay_kg_kg\n"
             "A,curves/a.csv,0.9,Z,10,0.1\n"
             "B,curves/b.csv,,P,,0.2\n"
             "C,curves/c.csv,0.7,NA,30,n/a\n"},
            {"curves/a.csv", "axial_stress_kPa,axial_strain\n15,0.001\n29,0.002\n57,0.004\n113,0.008\n"},
            {"curves/b.csv", "axial_stress_kPa,axial_strain_percent\n15,0.1\n29,0.2\n57,0.4\n113,0.8\n"},
            {"curves/c.csv", "axial_stress_kPa,axial_strain\n15,0.001\n29,0.002\n57,0.004\n113,0.008\n"}};
}

DataSet read(const Files& files) {
    const TemporaryFolder folder;
    write_all(folder, files);
    return read_data_set(folder.path());
}

UserError failure(const Files& files) {
    try {
        read(files);
    } catch (const UserError& error) {
        return error;
    }
    throw std::logic_error("was read");
}

TEST(ReadDataSet, ReadsRowsCovariatesAndCurves) {
    const DataSet set = read(sound_data_set());
    EXPECT_EQ(set.name, "three");
    EXPECT_EQ(set.kind, TestKind::oedometer);
    EXPECT_EQ(set.attribution, "nobody");
    EXPECT_FALSE(set.measured);
    EXPECT_EQ(set.covariates,
              (std::vector<std::string>{"initial_void_ratio", "texture", "depth_cm", "clay_kg_kg"}));
    ASSERT_EQ(set.rows.size(), 3u);
    const DataSetRow& second = set.rows[1];
    EXPECT_EQ(second.name, "B");
    EXPECT_EQ(second.line, 3);
    EXPECT_TRUE(std::holds_alternative<std::monostate>(second.covariates[0]));
    EXPECT_EQ(std::get<std::string>(second.covariates[1]), "P");
    EXPECT_TRUE(std::holds_alternative<std::monostate>(second.covariates[2]));
    EXPECT_EQ(std::get<double>(second.covariates[3]), 0.2);
    const lab_data::Test& test = std::get<lab_data::Test>(second.test);
    EXPECT_EQ(test.initial_void_ratio, std::nullopt);
    EXPECT_EQ(test.seating_stress, 2e3);
    EXPECT_EQ(test.column("axial_strain"), (std::vector<double>{0.001, 0.002, 0.004, 0.008}));
    EXPECT_EQ(std::get<lab_data::Test>(set.rows[0].test).initial_void_ratio, 0.9);
    EXPECT_TRUE(std::holds_alternative<std::monostate>(set.rows[2].covariates[1]));
    EXPECT_TRUE(set.warnings.empty());
}

TEST(ReadDataSet, ReturnsAnUnreadableSampleWithItsReason) {
    Files files = sound_data_set();
    files["curves/b.csv"] = replaced(files["curves/b.csv"], "0.4", "x");
    files["samples.csv"] = replaced(files["samples.csv"], "0.7,NA", "-1,NA");
    files.erase("curves/a.csv");
    const DataSet set = read(files);
    ASSERT_EQ(set.rows.size(), 3u);
    const auto reason = [&](std::size_t row) { return std::get<UserError>(set.rows[row].test); };
    EXPECT_NE(reason(0).file().find("samples.csv"), std::string::npos);
    EXPECT_EQ(reason(0).line(), 2);
    EXPECT_EQ(reason(0).value(), "curves/a.csv");
    EXPECT_EQ(reason(0).constraint(), "does not exist");
    EXPECT_EQ(reason(1).line(), 4);
    EXPECT_EQ(reason(1).column(), "axial_strain_percent");
    EXPECT_NE(reason(2).file().find("samples.csv"), std::string::npos);
    EXPECT_EQ(reason(2).line(), 4);
    EXPECT_EQ(reason(2).column(), "initial_void_ratio");
    EXPECT_EQ(set.rows[1].covariates.size(), 4u);
}

TEST(ReadDataSet, TakesNamesThatBeginWithAHash) {
    Files files = sound_data_set();
    files["samples.csv"] =
        "# exported\nsample,file\n#1,curves/a.csv\n# a remark\n\"#2\",curves/b.csv\nC,curves/c.csv\n";
    const DataSet set = read(files);
    ASSERT_EQ(set.rows.size(), 3u);
    EXPECT_EQ(set.rows[0].name, "#1");
    EXPECT_EQ(set.rows[1].name, "#2");
    EXPECT_EQ(set.rows[1].line, 5);
}

TEST(ReadDataSet, RefusesAFileOutsideOfTheFolder) {
    Files files = sound_data_set();
    files["samples.csv"] = replaced(files["samples.csv"], "curves/a.csv", "../a.csv");
    const DataSet set = read(files);
    EXPECT_EQ(std::get<UserError>(set.rows[0].test).line(), 2);
    EXPECT_TRUE(set.rows[1].readable());
}

TEST(ReadDataSet, TakesSettingsOfOtherKindsFromColumns) {
    Files files = sound_data_set();
    files["dataset.toml"] = "name = \"t\"\nkind = \"triaxial\"\nsource = \"s\"\nlicence = \"l\"\n";
    files["samples.csv"] = "sample,file,cell_pressure_kPa\nA,curves/t.csv,50\nB,curves/b.csv,\n";
    files["curves/t.csv"] = "axial_strain,deviatoric_stress_kPa,volumetric_strain\n0,0,0\n0.1,100,0\n";
    const DataSet set = read(files);
    EXPECT_EQ(std::get<lab_data::Test>(set.rows[0].test).cell_pressure, 50e3);
    EXPECT_EQ(std::get<UserError>(set.rows[1].test).column(), "cell_pressure_kPa");
}

TEST(ReadDataSet, WarnsOfAColumnThatIsNearlyNumbers) {
    Files files = sound_data_set();
    files["samples.csv"] = replaced(files["samples.csv"], ",30,", ",3O,");
    files["samples.csv"] = replaced(files["samples.csv"], "P,,", "P,20,");
    const DataSet set = read(files);
    EXPECT_EQ(std::get<std::string>(set.rows[0].covariates[2]), "10");
    ASSERT_EQ(set.warnings.size(), 1u);
    EXPECT_NE(set.warnings[0].find("samples.csv:4: column 'depth_cm' is taken as labels"), std::string::npos);
}

TEST(ReadDataSet, WarnsOfDecimalCommasInACovariate) {
    Files files = sound_data_set();
    files["samples.csv"] = "sample;file;clay\nA;curves/a.csv;1,5\nB;curves/b.csv;2,5\nC;curves/c.csv;3\n";
    const DataSet set = read(files);
    EXPECT_EQ(std::get<std::string>(set.rows[0].covariates[0]), "1,5");
    ASSERT_EQ(set.warnings.size(), 1u);
    EXPECT_NE(
        set.warnings[0].find(
            "samples.csv:3: column 'clay' is taken as labels, because '2,5' is not a number; write 2.5"),
        std::string::npos)
        << set.warnings[0];
}

TEST(ReadDataSet, KeepsTheWarningsOfAnUnreadableSample) {
    Files files = sound_data_set();
    std::string curve = "axial_stress_kPa;axial_strain\n";
    for (int i = 1; i <= 100; ++i) curve += std::to_string(i) + ";0,1\n";
    files["curves/b.csv"] = curve;
    const DataSet set = read(files);
    EXPECT_FALSE(set.rows[1].readable());
    ASSERT_EQ(set.warnings.size(), 1u);
    EXPECT_NE(set.warnings[0].find("b.csv: column 'axial_strain': 97 more errors of the same kind"),
              std::string::npos);
}

TEST(ReadDataSet, WarnsOfAColumnThatIsNearlyASetting) {
    Files files = sound_data_set();
    files["samples.csv"] = replaced(files["samples.csv"], "initial_void_ratio", "initial_voidratio");
    const DataSet set = read(files);
    ASSERT_EQ(set.warnings.size(), 1u);
    EXPECT_NE(set.warnings[0].find("did you mean 'initial_void_ratio'?"), std::string::npos);
}

TEST(ReadDataSet, AsksToConvertASettingOfAnotherUnit) {
    Files files = sound_data_set();
    files["dataset.toml"] = "name = \"t\"\nkind = \"triaxial\"\nsource = \"s\"\nlicence = \"l\"\n";
    files["samples.csv"] = "sample,file,cell_pressure_MPa\nA,curves/a.csv,0.05\n";
    EXPECT_EQ(failure(files).remedy(),
              "did you mean column 'cell_pressure_MPa'? If so, convert it to kPa and name it "
              "'cell_pressure_kPa'");
    files = sound_data_set();
    files["samples.csv"] = replaced(files["samples.csv"], "depth_cm", "seating_stress_Pa");
    files["dataset.toml"] = replaced(files["dataset.toml"], "seating_stress_kPa = 2\n", "");
    const DataSet set = read(files);
    ASSERT_EQ(set.warnings.size(), 1u);
    EXPECT_NE(set.warnings[0].find("convert it to kPa and name it 'seating_stress_kPa'"), std::string::npos);
}

TEST(ReadDataSet, ShowsNamesOfCovariatesHarmlessly) {
    Files files = sound_data_set();
    files["samples.csv"] =
        replaced(files["samples.csv"], "depth_cm", "\"depth\n" + std::string(5000, 'x') + "\"");
    files["samples.csv"] = replaced(files["samples.csv"], ",10,", ",\"1,0\",");
    const DataSet set = read(files);
    ASSERT_EQ(set.warnings.size(), 1u);
    EXPECT_NE(set.warnings[0].find("column 'depth\\x0axxx"), std::string::npos);
    EXPECT_LT(set.warnings[0].size(), 400u);
}

TEST(ReadDataSet, ThrowsForItsOwnFaults) {
    struct Spoilt {
        const char *file, *from, *to;
        int line;
        const char *column, *words;
    };
    const Spoilt cases[] = {
        {"dataset.toml", "kind", "knid", 0, "kind", "is missing"},
        {"dataset.toml", "\"oedometer\"", "\"odometer\"", 2, "kind", "did you mean 'oedometer'?"},
        {"dataset.toml", "attribution", "atribution", 5, "atribution", "did you mean 'attribution'?"},
        {"dataset.toml", "= 2\n", "= -2\n", 7, "seating_stress_kPa", "above 0"},
        {"dataset.toml", "= 2\n", "= two\n", 7, "", "not valid TOML"},
        {"dataset.toml", "kind = \"oedometer\"", "kind = \"triaxial\"", 7, "seating_stress_kPa",
         "does not belong"},
        {"samples.csv", "sample,file", "sampel,file", 1, "sample", "did you mean column 'sampel'?"},
        {"samples.csv", "sample,file", "sample,curve", 1, "file", "add the column"},
        {"samples.csv", "B,curves/b.csv", "A,curves/b.csv", 3, "sample", "is there twice"},
        {"samples.csv", "B,curves/b.csv", ",curves/b.csv", 3, "sample", "is empty"},
        {"samples.csv", "B,curves/b.csv", "B,curves/a.csv", 3, "file", "is there twice"},
        {"samples.csv", "depth_cm", "texture", 1, "texture", "is there twice"},
        {"samples.csv", "C,curves/c.csv", "C", 4, "", "5 cells"},
    };
    for (const Spoilt& spoilt : cases) {
        Files files = sound_data_set();
        files[spoilt.file] = replaced(files[spoilt.file], spoilt.from, spoilt.to);
        // The unknown key comes first in the file, what it was meant for second.
        if (std::string(spoilt.from) == "kind")
            files[spoilt.file] = replaced(files[spoilt.file], "knid = \"oedometer\"\n", "");
        const UserError error = failure(files);
        SCOPED_TRACE(error.what());
        EXPECT_TRUE(error.file().ends_with(spoilt.file));
        EXPECT_EQ(error.line(), spoilt.line);
        EXPECT_EQ(error.column(), spoilt.column);
        EXPECT_NE(std::string(error.what()).find(spoilt.words), std::string::npos);
    }
    Files files = sound_data_set();
    files.erase("samples.csv");
    EXPECT_TRUE(failure(files).file().ends_with("samples.csv"));
}

}  // namespace
}  // namespace loam::lab_data
