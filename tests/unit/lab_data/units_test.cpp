// Names with other units than those of the format, or none, and what is said of them.
#include "lab_data/units.hpp"

#include <gtest/gtest.h>

#include <array>

#include "lab_data/check.hpp"
#include "made_sample.hpp"

namespace loam::lab_data {
namespace {

/// All that is said of the spoilt sample, a line each.
std::string answers(const char* file, const std::string& from, const std::string& to) {
    Files files = sound_files();
    files.at(file) = replaced(files.at(file), from, to);
    const TemporaryFolder folder;
    write_all(folder, files);
    const CheckReport report = check(folder.path());
    std::string all;
    for (const UserError& error : report.errors) all += error.what() + std::string("\n");
    for (const std::string& warning : report.warnings) all += warning + "\n";
    return all;
}

void expect(const std::string& all, const std::string& words) {
    EXPECT_NE(all.find(words), std::string::npos) << words << " is not in " << all;
}

TEST(SplitUnit, TakesNamesApart) {
    struct Name {
        const char *written, *quantity, *unit;
    };
    for (const Name& name : {Name{"axial_stress_kPa", "axial_stress", "kPa"},
                             {"Axial stress (kPa)", "Axial stress", "kPa"},
                             {"axial stress [ kN/m2 ]", "axial stress", "kN/m2"},
                             {"axial strain, %", "axial strain", "%"},
                             {"axial_strain%", "axial_strain", "%"},
                             {"Shear Displacement / mm", "Shear Displacement", "mm"},
                             {"grain_density_kg_m3", "grain_density", "kg_m3"},
                             {"axial_stress_kg_cm2", "axial_stress", "kg_cm2"},
                             {"void_ratio", "void_ratio", ""},
                             {"axial_strain", "axial_strain", ""},
                             {"(kPa)", "(kPa)", ""},
                             {"", "", ""}}) {
        const WrittenName split = split_unit(name.written);
        EXPECT_EQ(split.quantity, name.quantity) << name.written;
        EXPECT_EQ(split.unit, name.unit) << name.written;
    }
}

TEST(SpeltUnit, KnowsOtherSpellings) {
    const auto suffix = [](const char* text, Dimension dimension) {
        const Unit* unit = spelt_unit(text, dimension);
        return unit ? std::string(unit->suffix) : "none";
    };
    EXPECT_EQ(suffix("%", Dimension::ratio), "percent");
    EXPECT_EQ(suffix("-", Dimension::ratio), "");
    EXPECT_EQ(suffix("KPA", Dimension::stress), "kPa");
    EXPECT_EQ(suffix("kN/m\xc2\xb2", Dimension::stress), "kPa");
    EXPECT_EQ(suffix("N/mm^2", Dimension::stress), "MPa");
    EXPECT_EQ(suffix("psi", Dimension::stress), "none");
    EXPECT_EQ(suffix("kPa", Dimension::length), "none");
    EXPECT_EQ(suffix("cm", Dimension::length), "none");
}

TEST(QuantityDistance, ComparesWordByWord) {
    EXPECT_EQ(quantity_distance("Axial Strain", "axial_strain"), 0u);
    EXPECT_EQ(quantity_distance("axial_strian", "axial_strain"), 1u);
    EXPECT_TRUE(quantity_distance("axialstrain", "axial_strain"));
    EXPECT_FALSE(quantity_distance("axial_stress", "axial_strain"));
    EXPECT_FALSE(quantity_distance("axial_stress", "lateral_stress"));
    EXPECT_FALSE(quantity_distance("vertical_displacement", "shear_displacement"));
    EXPECT_FALSE(quantity_distance("void_ratio_initial", "void_ratio"));
    EXPECT_FALSE(quantity_distance("", ""));
}

TEST(ColumnNames, AreOfferedWithTheUnitThatIsWritten) {
    const auto stress = [](const char* name) { return answers("oedometer.csv", "axial_stress_kPa", name); };
    const auto strain = [](const char* name) { return answers("oedometer.csv", "axial_strain", name); };
    expect(strain("axial_strain (%)"),
           "did you mean column 'axial_strain (%)'? Name it 'axial_strain_percent'");
    expect(strain("axial_strain_%"), "did you mean 'axial_strain_percent'?");
    expect(strain("Axial strain [-]"), "Name it 'axial_strain'\n");
    expect(strain("Axial Strain"),
           "Name it 'axial_strain' if it is a ratio, 'axial_strain_percent' if it is in percent");
    for (const char* unit : {"(psi)", "[bar]", "(kg/cm2)", "(N)", "(cm)"}) {
        const std::string all = stress((std::string("axial stress ") + unit).c_str());
        const std::string inside = std::string(unit).substr(1, std::string(unit).size() - 2);
        expect(all, "Its unit '" + inside +
                        "' cannot be read: convert it and name it axial_stress_kPa, "
                        "axial_stress_Pa or axial_stress_MPa");
    }
    expect(stress("Axial stress (kN/m2)"), "Name it 'axial_stress_kPa'");
    expect(stress("\"Axial stress, MPa\""), "Name it 'axial_stress_MPa'");
    const std::string all = stress("axial_stress_kpa");
    expect(all, "did you mean 'axial_stress_kPa'?");
    EXPECT_EQ(all.find("lateral_stress"), std::string::npos) << all;
}

TEST(ColumnNames, OfTheShearBoxAreNotTakenForEachOther) {
    const auto shear = [](const char* name) { return answers("shear.csv", "shear_displacement_mm", name); };
    expect(shear("shear displacement (cm)"), "Its unit 'cm' cannot be read: convert it");
    expect(shear("Shear Displacement"),
           "Its name must state the unit: shear_displacement_mm or shear_displacement_m");
    expect(shear("Shear strain (%)"), "Name it 'shear_strain_percent'");
    const std::string all = answers("shear.csv", "shear_displacement_mm,shear_stress_kPa,settlement_mm",
                                    "horizontal_displacement_mm,shear_stress_kPa,vertical_displacement_mm");
    expect(all, "'shear_displacement' is missing; add it as shear_displacement_mm");
    expect(all, "'settlement' is missing; add it as settlement_mm");
    EXPECT_EQ(all.find("did you mean"), std::string::npos) << all;
}

TEST(ColumnNames, OfOptionalQuantitiesWarnWithTheirUnit) {
    const auto normal = [](const char* name) { return answers("shear.csv", "normal_stress_kPa", name); };
    expect(normal("Normal stress [MPa]"), "is ignored; did you mean 'normal_stress_MPa'?");
    expect(normal("normal stress (psi)"), "did you mean 'normal_stress'? Its unit 'psi' cannot be read");
}

TEST(ColumnNames, OfAnyLengthAndKindAreShownHarmlessly) {
    const std::string million(1 << 20, 'x');
    for (const std::string& name :
         {"axial_stress_" + million, "axial stress (" + million + ")", "axial_stress_kPa," + million}) {
        Files files = sound_files();
        files["oedometer.csv"] = name + ",axial_strain\n1,2,0\n2,3,0.1\n";
        if (!name.starts_with("axial_stress_kPa"))
            files["oedometer.csv"] = name + ",axial_strain\n1,0\n2,0.1\n";
        const TemporaryFolder folder;
        write_all(folder, files);
        const CheckReport report = check(folder.path());
        for (const UserError& error : report.errors) EXPECT_LT(std::string(error.what()).size(), 1000u);
        for (const std::string& warning : report.warnings) EXPECT_LT(warning.size(), 1000u);
    }
    const std::string all = answers("oedometer.csv", "axial_stress_kPa", "\"Axial\n stress (kPa)\"");
    expect(all, "did you mean column 'Axial\\x0a stress (kPa)'? Name it 'axial_stress_kPa'");
    expect(answers("shear.csv", "normal_stress_kPa", "\"Normal\nstress (kPa)\""),
           "column 'Normal\\x0astress (kPa)' is ignored");
}

TEST(Keys, WithAnotherUnitAreToBeConverted) {
    const auto key = [](const char* from, const char* to) { return answers("sample.toml", from, to); };
    expect(key("box_length_mm = 60", "box_length_cm = 6"), "convert it to mm and name it 'box_length_mm'");
    expect(key("cell_pressure_kPa", "cell_pressure_MPa"),
           "convert it to kPa and name it 'cell_pressure_kPa'");
    expect(key("cell_pressure_kPa", "cell_pressure"), "did you mean 'cell_pressure_kPa'? Give it in kPa");
    expect(key("cell_pressure_kPa", "cell_pressure_kpa"), "did you mean 'cell_pressure_kPa'?");
    expect(key("box_length_mm = 60", "box_length_mm = 60\nwall_friction_angle_deg = 20"),
           "convert it to rad and name it 'wall_friction_angle_rad'");
    expect(key("grain_density_kg_m3", "grain_density_g_cm3"),
           "convert it to kg_m3 and name it 'grain_density_kg_m3'");
    expect(key("initial_void_ratio = 0.8", "initial_void_ratio_percent = 80"),
           "convert it to a number without unit and name it 'initial_void_ratio'");
}

TEST(Renaming, OfAColumnOfSamplesIsByItsUnit) {
    EXPECT_EQ(renaming("cell_presure_kPa", "cell_pressure_kPa"), "name it 'cell_pressure_kPa'");
    EXPECT_EQ(renaming("cell_pressure", "cell_pressure_kPa"),
              "name it 'cell_pressure_kPa' if it is in kPa, else convert it to kPa first");
    EXPECT_EQ(renaming("cell_pressure_bar", "cell_pressure_kPa"),
              "convert it to kPa and name it 'cell_pressure_kPa'");
    EXPECT_EQ(renaming("Cell pressure (kN/m2)", "cell_pressure_kPa"), "name it 'cell_pressure_kPa'");
}

}  // namespace
}  // namespace loam::lab_data
