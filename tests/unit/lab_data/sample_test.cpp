#include "lab_data/sample.hpp"

#include <gtest/gtest.h>

#include "made_sample.hpp"

namespace loam::lab_data {
namespace {

Sample read(const Files& files) {
    const TemporaryFolder folder;
    write_all(folder, files);
    return read_sample(folder.path());
}

TEST(ReadSample, ReadsWhatTheFilesSayInSi) {
    const Sample sample = read(sound_files());
    EXPECT_EQ(sample.name, "test-sand");
    EXPECT_EQ(sample.source, "made up");
    EXPECT_EQ(sample.licence, "CC0-1.0");
    EXPECT_FALSE(sample.measured);
    EXPECT_EQ(sample.grain_density, 2650);
    EXPECT_EQ(std::get<double>(sample.properties.at("clay_kg_kg")), 0.02);
    EXPECT_EQ(std::get<std::string>(sample.properties.at("origin")), "river");
    ASSERT_EQ(sample.grading.size(), 3u);  // by rising sieve, though the file falls
    EXPECT_EQ(sample.grading[0].sieve, 0.5e-3);
    EXPECT_EQ(sample.grading[0].passing, 0.1);
    EXPECT_EQ(sample.grading[2].passing, 1);
    ASSERT_EQ(sample.tests.size(), 3u);

    const lab_data::Test& oedometer = sample.tests[0];
    EXPECT_EQ(oedometer.kind, TestKind::oedometer);
    EXPECT_EQ(oedometer.file, "oedometer.csv");
    EXPECT_EQ(oedometer.initial_void_ratio, 0.8);
    EXPECT_EQ(oedometer.seating_stress, std::nullopt);
    EXPECT_EQ(oedometer.column("axial_stress"),
              (std::vector<double>{10e3, 20e3, 40e3, 80e3, 20e3, 80e3, 160e3}));
    EXPECT_EQ(oedometer.column("axial_strain"),
              (std::vector<double>{0, 0.004, 0.01, 0.02, 0.018, 0.021, 0.035}));
    EXPECT_EQ(oedometer.phase[4], "unloading");
    EXPECT_EQ(oedometer.lines, (std::vector<int>{2, 3, 4, 5, 6, 7, 8}));
    EXPECT_TRUE(oedometer.measurement_sd.empty());

    const lab_data::Test& triaxial = sample.tests[1];
    EXPECT_EQ(triaxial.kind, TestKind::triaxial);
    EXPECT_EQ(triaxial.cell_pressure, 100e3);
    EXPECT_EQ(triaxial.initial_void_ratio, std::nullopt);
    EXPECT_EQ(triaxial.column("axial_strain"), (std::vector<double>{0, 0.01, 0.02, 0.0195, 0.05}));
    EXPECT_EQ(triaxial.column("deviatoric_stress")[4], 210e3);
    EXPECT_EQ(triaxial.column("volumetric_strain")[4], -0.008);

    const lab_data::Test& shear = sample.tests[2];
    EXPECT_EQ(shear.kind, TestKind::direct_shear);
    EXPECT_EQ(shear.normal_stress, 100e3);
    EXPECT_EQ(shear.box_length, 0.06);
    EXPECT_EQ(shear.box_width, 0.06);
    EXPECT_EQ(shear.box_height, 0.025);
    EXPECT_EQ(shear.column("shear_displacement")[3], 6e-3);
    EXPECT_EQ(shear.column("settlement")[3], -0.2e-3);
    EXPECT_EQ(shear.column("normal_stress")[1], 99e3);
}

TEST(ReadSample, TakesTheFolderOrItsFile) {
    const TemporaryFolder folder;
    write_all(folder, sound_files());
    EXPECT_EQ(read_sample(folder.path() / "sample.toml").tests.size(), 3u);
    EXPECT_EQ(read_sample(folder.path().string() + "/").name, "test-sand");
}

TEST(ReadSample, WarnsOfNoiseAndKeepsIt) {
    const Sample sample = read(sound_files());
    ASSERT_EQ(sample.warnings.size(), 1u);
    EXPECT_NE(sample.warnings[0].find("triaxial.csv: 1 of 5 readings of axial_strain do not rise"),
              std::string::npos);
}

TEST(ReadSample, TakesNoisyMeasurementsAsData) {
    Files files = sound_files();
    // A slightly negative first reading, repeated and slightly falling strains.
    files["oedometer.csv"] =
        "axial_stress_kPa,axial_strain_percent\n10,-0.06\n20,0.1\n40,0.1\n80,0.09\n160,1\n";
    std::string many = "axial_strain,deviatoric_stress_kPa,volumetric_strain\n";
    for (int i = 0; i < 900; ++i)
        many += std::to_string(i * 1e-4 - (i % 3) * 1.5e-4) + "," + std::to_string(i % 40 - 2) + ",0\n";
    files["triaxial.csv"] = many;
    const Sample sample = read(files);
    EXPECT_EQ(sample.tests[0].column("axial_strain"),
              (std::vector<double>{-0.0006, 0.001, 0.001, 0.0009, 0.01}));
    EXPECT_TRUE(sample.tests[0].phase.empty());
    EXPECT_EQ(sample.tests[1].size(), 900u);
}

TEST(ReadSample, TakesTheDialectsOfSpreadsheets) {
    Files files = sound_files();
    files["oedometer.csv"] =
        "\xef\xbb\xbf# exported\r\n\r\n \"axial_stress_MPa\" ; axial_strain_percent;remark\r\n"
        "0.01; 0 ;\"first; with \"\"care\"\"\"\r\n\r\n0.02;+4e-1;\r\n;;\r\n0.04;1.;x;\r\n\r\n";
    files["triaxial.csv"] =
        "axial_strain\tdeviatoric_stress_Pa\tvolumetric_strain\r0\t0\t0\r0.01\t1e5\t0.001";
    const Sample sample = read(files);
    const lab_data::Test& oedometer = sample.tests[0];
    EXPECT_EQ(oedometer.column("axial_stress"), (std::vector<double>{10e3, 20e3, 40e3}));
    EXPECT_EQ(oedometer.column("axial_strain"), (std::vector<double>{0, 0.004, 0.01}));
    EXPECT_EQ(oedometer.lines, (std::vector<int>{4, 6, 8}));
    EXPECT_EQ(oedometer.other_columns.at("remark"),
              (std::vector<std::string>{"first; with \"care\"", "", "x"}));
    EXPECT_EQ(sample.tests[1].column("deviatoric_stress"), (std::vector<double>{0, 1e5}));
    EXPECT_EQ(sample.tests[1].lines, (std::vector<int>{2, 3}));
}

TEST(ReadSample, PassesOverCommentsAnywhere) {
    Files files = sound_files();
    files["oedometer.csv"] =
        "# stress, strain, remark, in this order\n,,\naxial_stress_kPa,axial_strain\n# 5\" ring\n10,0\n"
        "#\n# stages 2, 3, and 4\n20,0.004\n";
    files["triaxial.csv"] = replaced(files["triaxial.csv"], "0,0,0\n", "#first\n0,0,0\n");
    const Sample sample = read(files);
    EXPECT_EQ(sample.tests[0].lines, (std::vector<int>{5, 8}));
    EXPECT_EQ(sample.tests[1].size(), 5u);
}

TEST(ReadSample, KeepsAndIgnoresUnknownColumns) {
    Files files = sound_files();
    files["oedometer.csv"] =
        "stage,axial_stress_kPa,axial_strain,mv_m2_per_MN,axial_strain_from_mv_percent,void_ratio_initial\n"
        "a,10,0.001,,,0.8\nb,20,0.004,n/a,x,0.8\n";
    const Sample sample = read(files);
    const lab_data::Test& test = sample.tests[0];
    EXPECT_EQ(test.columns.size(), 2u);
    EXPECT_EQ(test.other_columns.size(), 4u);
    EXPECT_EQ(test.other_columns.at("mv_m2_per_MN"), (std::vector<std::string>{"", "n/a"}));
}

TEST(ReadSample, LeavesOutAnOptionalColumnWithGaps) {
    Files files = sound_files();
    files["oedometer.csv"] = "axial_stress_kPa,axial_strain,lateral_stress_kPa\n10,0,\n20,0.004,8\n";
    const Sample sample = read(files);
    EXPECT_FALSE(sample.tests[0].columns.contains("lateral_stress"));
    EXPECT_NE(sample.warnings.at(0).find("'lateral_stress_kPa' has empty cells"), std::string::npos);
}

TEST(ReadSample, WarnsOfAnIgnoredColumnThatIsNearlyAKnownOne) {
    Files files = sound_files();
    files["oedometer.csv"] = "phse,axial_stress_kPa,axial_strain\nloading,10,0\nloading,20,0.004\n";
    EXPECT_NE(read(files).warnings.at(0).find("did you mean 'phase'?"), std::string::npos);
}

TEST(ReadSample, WarnsOfAStrengthThatNoSoilHas) {
    const auto warnings = [](const std::string& file, const std::string& from, const std::string& to) {
        Files files = sound_files();
        files[file] = replaced(files[file], from, to);
        std::string all;
        for (const std::string& warning : read(files).warnings) all += warning + "\n";
        return all;
    };
    const std::string asks = "; are the units right?";
    EXPECT_NE(warnings("triaxial.csv", "5,210,", "5,210000,")
                  .find("triaxial.csv: deviatoric_stress_kPa reaches 2.1e+03 times the cell pressure" + asks),
              std::string::npos);
    EXPECT_NE(warnings("sample.toml", "normal_stress_kPa = 100", "normal_stress_kPa = 100000")
                  .find("shear.csv: shear_stress_kPa reaches 0.00062 times the normal stress" + asks),
              std::string::npos);
    EXPECT_EQ(warnings("triaxial.csv", "5,210,", "5,4900,").find(asks), std::string::npos);
}

TEST(ReadSample, ConvertsStrainsOfTheShearBox) {
    Files files = sound_files();
    files["shear.csv"] =
        "shear_strain_percent,shear_stress_kPa,settlement_strain\n0,0,0\n5,30,0.01\n10,40,-0.02\n";
    const Sample sample = read(files);
    const lab_data::Test& test = sample.tests[2];
    EXPECT_DOUBLE_EQ(test.column("shear_displacement")[1], 0.05 * 0.06);
    EXPECT_DOUBLE_EQ(test.column("settlement")[2], -0.02 * 0.025);
    EXPECT_FALSE(test.columns.contains("shear_strain"));
    EXPECT_FALSE(test.columns.contains("settlement_strain"));
}

TEST(ReadSample, ReadsTheOptionalSettings) {
    Files files = sound_files();
    std::string& toml = files["sample.toml"];
    toml = replaced(toml, "initial_void_ratio = 0.8", "seating_stress_kPa = 2\nmeasurement_sd = 0.0005");
    toml = replaced(toml, "cell_pressure_kPa = 100",
                    "cell_pressure_kPa = 1e2\n"
                    "measurement_sd = {deviatoric_stress_kPa = 2, volumetric_strain_percent = 0.05}");
    toml += "box_width_mm = 40\nwall_friction_angle_rad = 0.2\n";
    const Sample sample = read(files);
    EXPECT_EQ(sample.tests[0].seating_stress, 2e3);
    EXPECT_EQ(sample.tests[0].measurement_sd.at("axial_strain"), 0.0005);
    EXPECT_EQ(sample.tests[1].measurement_sd.at("deviatoric_stress"), 2e3);
    EXPECT_EQ(sample.tests[1].measurement_sd.at("volumetric_strain"), 0.0005);
    EXPECT_EQ(sample.tests[2].box_width, 0.04);
    EXPECT_EQ(sample.tests[2].wall_friction_angle, 0.2);
}

TEST(SeatingStress, IsStatedOrReadOrUsual) {
    lab_data::Test test;
    test.columns = {{"axial_stress", {10e3, 20e3}}, {"axial_strain", {0, 0.01}}};
    EXPECT_EQ(seating_stress(test), 10e3);  // the first stage's, whose strain is zero
    test.columns["axial_strain"][0] = 0.001;
    EXPECT_EQ(seating_stress(test), 2e3);
    test.columns["axial_stress"][0] = 3e3;
    EXPECT_EQ(seating_stress(test), 1.5e3);
    test.seating_stress = 1e3;
    EXPECT_EQ(seating_stress(test), 1e3);
}

TEST(ShippedSamples, AreSound) {
    const std::filesystem::path sets = std::filesystem::path(LOAM_SOURCE_DIR) / "lab_data/sets";
    const Sample dobrany = read_sample(sets / "dobrany_sand");
    ASSERT_EQ(dobrany.tests.size(), 4u);
    EXPECT_EQ(dobrany.tests[0].size(), 13u);
    EXPECT_EQ(dobrany.tests[0].column("axial_stress")[8], 1200e3);
    EXPECT_NEAR(dobrany.tests[0].column("axial_strain")[8], 0.106347, 1e-12);
    EXPECT_EQ(seating_stress(dobrany.tests[0]), 8e3);
    EXPECT_EQ(dobrany.tests[3].size(), 180u);
    EXPECT_EQ(dobrany.grading.back().sieve, 0.125);
    const Sample toyoura = read_sample(sets / "toyoura_sand");
    ASSERT_EQ(toyoura.tests.size(), 3u);
    EXPECT_EQ(toyoura.tests[2].cell_pressure, 1e6);
    EXPECT_EQ(toyoura.tests[2].other_columns.at("stress_ratio_s1_s3")[0], "1.68");
    EXPECT_TRUE(toyoura.measured);
}

}  // namespace
}  // namespace loam::lab_data
