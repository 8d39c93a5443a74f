#include "lab_data/check.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "lab_data/data_set.hpp"
#include "lab_data/sample.hpp"
#include "made_sample.hpp"

namespace loam::lab_data {
namespace {

TEST(Check, TellsWhatAPathIs) {
    const TemporaryFolder folder;
    folder.write("a/sample.toml", "");
    folder.write("b/dataset.toml", "");
    folder.write("c/sample.toml", "");
    folder.write("c/dataset.toml", "");
    folder.write("d/config.toml", "");
    EXPECT_EQ(kind_of(folder.path() / "a"), PathKind::sample);
    EXPECT_EQ(kind_of(folder.path() / "a/sample.toml"), PathKind::sample);
    EXPECT_EQ(kind_of(folder.path() / "b"), PathKind::data_set);
    EXPECT_EQ(kind_of(folder.path() / "b/dataset.toml"), PathKind::data_set);
    EXPECT_EQ(kind_of(folder.path() / "d/config.toml"), PathKind::other_file);
    EXPECT_THROW(kind_of(folder.path() / "c"), UserError);
    EXPECT_THROW(kind_of(folder.path() / "d"), UserError);
    EXPECT_THROW(kind_of(folder.path() / "e"), UserError);
    EXPECT_THROW(check(folder.path() / "d/config.toml"), UserError);
}

UserError failure(const std::function<void()>& reading) {
    try {
        reading();
    } catch (const UserError& error) {
        return error;
    }
    throw std::logic_error("was read");
}

TEST(Check, TellsASampleFromADataSet) {
    const TemporaryFolder folder;
    folder.write("a/sample.toml", "");
    folder.write("b/dataset.toml", "");
    for (const char* path : {"b", "b/dataset.toml"}) {
        const UserError error = failure([&] { read_sample(folder.path() / path); });
        EXPECT_EQ(error.constraint(), "is a data set, not a sample");
        EXPECT_NE(error.remedy().find("loam bulk"), std::string::npos);
    }
    for (const char* path : {"a", "a/sample.toml"}) {
        const UserError error = failure([&] { read_data_set(folder.path() / path); });
        EXPECT_EQ(error.constraint(), "is a sample, not a data set");
        EXPECT_NE(error.remedy().find("loam calibrate"), std::string::npos);
    }
}

TEST(Check, NamesTheFolderOfATable) {
    const TemporaryFolder folder;
    folder.write("a/sample.toml", "");
    folder.write("a/oedometer.csv", "");
    folder.write("b/dataset.toml", "");
    folder.write("b/curves/1.csv", "");
    folder.write("c/1.csv", "");
    const auto remedy = [&](const char* file) {
        return failure([&] { kind_of(folder.path() / file); }).remedy();
    };
    EXPECT_EQ(remedy("a/oedometer.csv"), "name the folder '" + (folder.path() / "a").string() + "'");
    EXPECT_EQ(remedy("b/curves/1.csv"), "name the folder '" + (folder.path() / "b").string() + "'");
    EXPECT_EQ(remedy("c/1.csv"), "name the folder that holds its sample.toml or dataset.toml");
}

TEST(Check, DescribesASoundSample) {
    const TemporaryFolder folder;
    write_all(folder, sound_files());
    const CheckReport report = check(folder.path());
    EXPECT_TRUE(report.sound());
    EXPECT_EQ(report.name, "test-sand");
    EXPECT_EQ(report.contents, (std::vector<std::string>{"oedometer oedometer.csv: 7 readings",
                                                         "triaxial triaxial.csv: 5 readings",
                                                         "direct_shear shear.csv: 4 readings"}));
    EXPECT_EQ(report.warnings.size(), 1u);
}

TEST(Check, CollectsAllFaultsInOneGo) {
    Files files = sound_files();
    files["sample.toml"] = replaced(files["sample.toml"], "0.8", "-0.8");
    files["sample.toml"] = replaced(files["sample.toml"], "licence", "license");
    files["oedometer.csv"] = replaced(files["oedometer.csv"], "0.004", "x");
    files["oedometer.csv"] = replaced(files["oedometer.csv"], "unloading", "down");
    files.erase("triaxial.csv");
    files["shear.csv"] = replaced(files["shear.csv"], "settlement_mm", "height");
    const TemporaryFolder folder;
    write_all(folder, files);
    const CheckReport report = check(folder.path());
    std::vector<std::string> places;
    for (const UserError& error : report.errors)
        places.push_back(std::filesystem::path(error.file()).filename().string() + ":" +
                         std::to_string(error.line()) + ":" + error.column());
    EXPECT_EQ(places, (std::vector<std::string>{"sample.toml:0:licence", "sample.toml:3:license",
                                                "sample.toml:14:initial_void_ratio",
                                                "oedometer.csv:3:axial_strain", "oedometer.csv:6:phase",
                                                "sample.toml:17:file", "shear.csv:1:settlement"}));
}

TEST(Check, CountsWhatRepeatsItself) {
    Files files = sound_files();
    std::string text = "axial_stress_kPa;axial_strain\n";
    for (int i = 1; i <= 100; ++i) text += std::to_string(i) + ";0,1\n";
    files["oedometer.csv"] = text;
    const TemporaryFolder folder;
    write_all(folder, files);
    const CheckReport report = check(folder.path());
    EXPECT_EQ(report.errors.size(), 3u);
    EXPECT_NE(report.warnings.at(0).find("column 'axial_strain': 97 more errors"), std::string::npos);
}

TEST(Check, TakesNoiseOfAStiffSoilForNoise) {
    // A fall of more than half of the range, of a resolution that no soil test has better.
    Files files = sound_files();
    files["oedometer.csv"] = "axial_stress_kPa,axial_strain\n10,0.0003\n20,0.0005\n40,0.0001\n";
    const TemporaryFolder folder;
    write_all(folder, files);
    EXPECT_TRUE(check(folder.path()).sound());
}

TEST(Check, ReportsTheUnreadableSamplesOfADataSet) {
    const TemporaryFolder folder;
    folder.write("dataset.toml", "name = \"d\"\nkind = \"oedometer\"\nsource = \"s\"\nlicence = \"l\"\n");
    folder.write("samples.csv", "sample,file\nA,a.csv\nB,b.csv\nC,c.csv\n");
    folder.write("c.csv", "axial_stress_kPa,axial_strain\n15,x\n29,y\n");
    folder.write("a.csv", "axial_stress_kPa,axial_strain\n15,0.001\n29,0.002\n");
    const CheckReport report = check(folder.path());
    EXPECT_EQ(report.contents,
              (std::vector<std::string>{"oedometer: 1 of 3 samples readable, 0 covariates"}));
    ASSERT_EQ(report.errors.size(), 3u);
    EXPECT_EQ(report.errors[0].file(), (folder.path() / "samples.csv").string());
    EXPECT_EQ(report.errors[0].line(), 3);
    EXPECT_EQ(report.errors[2].line(), 3) << "every fault of a curve is told";
}

}  // namespace
}  // namespace loam::lab_data
