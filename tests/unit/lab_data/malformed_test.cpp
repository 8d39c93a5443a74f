// Each way to get a sample wrong, with the file, line and words that the answer must have.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "lab_data/check.hpp"
#include "lab_data/sample.hpp"
#include "made_sample.hpp"

namespace loam::lab_data {
namespace {

struct Case {
    const char* name;
    std::function<void(Files&)> spoil;
    const char* file;    // of the error
    int line;            // 0: none
    const char* column;  // empty: none
    const char* words;   // in the message
    const char* remedy;  // in the remedy
};

std::ostream& operator<<(std::ostream& stream, const Case& spoilt) {
    return stream << spoilt.name;
}

std::function<void(Files&)> edit(const char* file, const char* from, const char* to) {
    return [=](Files& files) { files.at(file) = replaced(files.at(file), from, to); };
}

std::function<void(Files&)> write(const char* file, std::string text) {
    return [=](Files& files) { files[file] = text; };
}

const char* const toml = "sample.toml";
const char* const oedometer = "oedometer.csv";
const char* const triaxial = "triaxial.csv";
const char* const shear = "shear.csv";
const char* const grading = "grading.csv";

std::vector<Case> toml_cases() {
    return {
        {"no_sample_file", [](Files& f) { f["sample.tolm"] = f.extract(toml).mapped(); }, toml, 0, "",
         "does not exist", "did you mean 'sample.tolm'"},
        {"syntax", edit(toml, "licence = \"CC0-1.0\"", "licence = CC0-1.0"), toml, 3, "", "not valid TOML",
         "double quotes"},
        {"open_quotes", edit(toml, "\"made up\"", "\"made up"), toml, 2, "", "not valid TOML",
         "close the double quotes"},
        {"no_value", edit(toml, "= 2650", "="), toml, 6, "", "not valid TOML", "write a value"},
        {"decimal_comma_in_toml", edit(toml, "= 0.8", "= 0,8"), toml, 14, "", "not valid TOML", "write 0.8"},
        {"deep_key_in_quotes",
         [](Files& f) {
             for (int k = 0; k < 40'000; ++k) f[toml] += k ? ".\"$\"" : "\"$\"";
         },
         toml, 25, "", "more than 16 parts", "use the keys of the format"},
        {"sd_twice",
         edit(toml, "cell_pressure_kPa = 100",
              "cell_pressure_kPa = 100\nmeasurement_sd = {deviatoric_stress_kPa = 2, deviatoric_stress_Pa = "
              "2}"),
         toml, 19, "deviatoric_stress_kPa", "has one already", "one standard deviation"},
        {"key_twice", edit(toml, "measured = false", "name = \"other\""), toml, 4, "", "not valid TOML",
         "remove one of the two"},
        {"open_header", edit(toml, "[soil]", "[soil"), toml, 5, "", "not valid TOML", "[name]"},
        {"unknown_key", edit(toml, "licence =", "license ="), toml, 3, "license", "not known",
         "did you mean 'licence'?"},
        {"unknown_soil_key", edit(toml, "grading =", "gradng ="), toml, 7, "gradng", "not known",
         "did you mean 'grading'?"},
        {"unknown_test_key", edit(toml, "cell_pressure_kPa", "cell_presure_kPa"), toml, 18,
         "cell_presure_kPa", "not known", "did you mean 'cell_pressure_kPa'?"},
        {"wrong_unit_in_key", edit(toml, "cell_pressure_kPa", "cell_pressure"), toml, 18, "cell_pressure",
         "not known", "did you mean 'cell_pressure_kPa'?"},
        {"key_of_another_kind", edit(toml, "initial_void_ratio", "cell_pressure_kPa"), toml, 14,
         "cell_pressure_kPa", "does not belong", "triaxial"},
        {"no_name", edit(toml, "name = \"test-sand\"\n", ""), toml, 0, "name", "is missing", "name = "},
        {"empty_name", edit(toml, "\"test-sand\"", "\" \""), toml, 1, "name", "not empty", "name it"},
        {"name_with_slash", edit(toml, "test-sand", "../sand"), toml, 1, "name", "folder", "letters"},
        {"no_source", edit(toml, "source = \"made up\"\n", ""), toml, 0, "source", "is missing", "come from"},
        {"measured_is_text", edit(toml, "= false", "= \"no\""), toml, 4, "measured", "true or false",
         "without quotes"},
        {"name_is_number", edit(toml, "\"test-sand\"", "12"), toml, 1, "name", "must be a text",
         "double quotes"},
        {"no_soil",
         edit(toml,
              "[soil]\ngrain_density_kg_m3 = 2650\ngrading = \"grading.csv\"\n[soil.properties]\n"
              "clay_kg_kg = 0.02\norigin = \"river\"\n",
              ""),
         toml, 0, "soil", "is missing", "grain_density_kg_m3 = 2650"},
        {"no_density", edit(toml, "grain_density_kg_m3 = 2650\n", ""), toml, 5, "grain_density_kg_m3",
         "is missing", "2650"},
        {"density_in_g_cm3", edit(toml, "2650", "2.65"), toml, 6, "grain_density_kg_m3", "from 500 to 20000",
         "2650"},
        {"density_as_text", edit(toml, "2650", "\"2650\""), toml, 6, "grain_density_kg_m3", "finite number",
         "leave the quotes out"},
        {"density_infinite", edit(toml, "2650", "inf"), toml, 6, "grain_density_kg_m3", "finite number",
         "number"},
        {"property_is_a_list", edit(toml, "0.02", "[1, 2]"), toml, 9, "clay_kg_kg", "number or a text",
         "one number"},
        {"no_tests", [](Files& f) { f[toml].resize(f[toml].find("[[test]]")); }, toml, 0, "test",
         "is missing", "[[test]]"},
        {"one_bracket",
         [](Files& f) {
             f[toml] =
                 replaced(f[toml].substr(0, f[toml].find("[[test]]\nkind = \"tri")), "[[test]]", "[test]");
         },
         toml, 11, "test", "list of tables", "[[test]]"},
        {"unknown_kind", edit(toml, "\"triaxial\"", "\"triaxal\""), toml, 16, "kind", "no kind of test",
         "did you mean 'triaxial'?"},
        {"no_kind", edit(toml, "kind = \"oedometer\"\n", ""), toml, 11, "kind", "is missing", "oedometer"},
        {"no_file", edit(toml, "file = \"oedometer.csv\"\n", ""), toml, 11, "file", "is missing", "file ="},
        {"absolute_file", edit(toml, "\"oedometer.csv\"", "\"/etc/passwd\""), toml, 13, "file",
         "must lie in the folder", "copy the file"},
        {"file_above", edit(toml, "\"oedometer.csv\"", "\"a/../../oedometer.csv\""), toml, 13, "file",
         "must lie in the folder", "copy the file"},
        {"backslash", edit(toml, "\"oedometer.csv\"", "'curves\\oedometer.csv'"), toml, 13, "file",
         "backslashes", "with /"},
        {"control_character", edit(toml, "\"oedometer.csv\"", "\"oedo\\u0000meter.csv\""), toml, 13, "file",
         "control characters", "rename"},
        {"file_twice", edit(toml, "\"triaxial.csv\"", "\"./oedometer.csv\""), toml, 17, "file",
         "file of two tests", "its own file"},
        {"negative_void_ratio", edit(toml, "0.8", "-0.8"), toml, 14, "initial_void_ratio",
         "value '-0.8' must be above 0 and at most 30", "0.65"},
        {"void_ratio_as_text", edit(toml, "0.8", "\"0,8\""), toml, 14, "initial_void_ratio", "finite number",
         "write 0.8"},
        {"no_cell_pressure", edit(toml, "cell_pressure_kPa = 100\n", ""), toml, 15, "cell_pressure_kPa",
         "is missing", "cell_pressure_kPa = 100"},
        {"zero_cell_pressure", edit(toml, "cell_pressure_kPa = 100", "cell_pressure_kPa = 0"), toml, 18,
         "cell_pressure_kPa", "above 0", "effective cell pressure"},
        {"zero_seating_stress", edit(toml, "initial_void_ratio = 0.8", "seating_stress_kPa = 0"), toml, 14,
         "seating_stress_kPa", "above 0", "leave it out"},
        {"no_normal_stress", edit(toml, "normal_stress_kPa = 100\n", ""), toml, 19, "normal_stress_kPa",
         "is missing", "normal_stress_kPa = 100"},
        {"no_box", edit(toml, "box_length_mm = 60\n", ""), toml, 19, "box_length_mm", "is missing",
         "box_length_mm = 60"},
        {"angle_in_degrees",
         edit(toml, "box_length_mm = 60", "box_length_mm = 60\nwall_friction_angle_rad = 20"), toml, 24,
         "wall_friction_angle_rad", "at most 1.57", "0.349"},
        {"ambiguous_sd",
         edit(toml, "cell_pressure_kPa = 100", "cell_pressure_kPa = 100\nmeasurement_sd = 0.1"), toml, 19,
         "measurement_sd", "which channel", "volumetric_strain"},
        {"sd_of_no_channel", edit(toml, "initial_void_ratio = 0.8", "measurement_sd = {strain = 0.1}"), toml,
         14, "strain", "no channel", "axial_strain"},
        {"negative_sd", edit(toml, "initial_void_ratio = 0.8", "measurement_sd = -1e-4"), toml, 14,
         "measurement_sd", "above 0", "0.0001"},
        {"deep_key",
         [](Files& f) {
             std::string key = "a";
             for (int i = 0; i < 50000; ++i) key += ".a";
             f[toml] += key + " = 1\n";
         },
         toml, 25, "", "key of more than", "use the keys"},
        {"deep_value", [](Files& f) { f[toml] += "notes = " + std::string(100000, '['); }, toml, 25, "",
         "not valid TOML", ""},
        {"binary_toml", write(toml, std::string("name\0= 1", 8)), toml, 1, "", "binary", "text file"},
        {"huge_toml", write(toml, std::string(1 << 20, '#')), toml, 0, "", "bytes", "split"},
        {"empty_toml", write(toml, ""), toml, 0, "name", "is missing", "name"},
    };
}

std::vector<Case> table_cases() {
    return {
        {"missing_file", [](Files& f) { f["oedometr.csv"] = f.extract(oedometer).mapped(); }, toml, 13,
         "file", "'oedometer.csv' does not exist", "did you mean 'oedometr.csv'?"},
        {"missing_grading", [](Files& f) { f["grading.cvs"] = f.extract(grading).mapped(); }, toml, 7,
         "grading", "'grading.csv' does not exist", "did you mean 'grading.cvs'?"},
        {"folder_for_file",
         [](Files& f) {
             f["oedometer.csv/inside"] = "";
             f.erase(oedometer);
         },
         toml, 13, "file", "is a folder", "name a file"},
        {"empty_file", write(oedometer, ""), oedometer, 0, "", "is empty", "column names"},
        {"blank_file", write(oedometer, "\n  \n,,\n"), oedometer, 0, "", "is empty", "column names"},
        {"header_only", write(oedometer, "\naxial_stress_kPa,axial_strain\n\n"), oedometer, 2, "",
         "no readings", "row for each reading"},
        {"no_header", write(oedometer, "10,0\n20,0.004\n40,0.01\n"), oedometer, 1, "", "names should be",
         "row of names"},
        {"header_commented_out", write(oedometer, "# axial_stress_kPa,axial_strain\n10,0\n20,0.004\n"),
         oedometer, 2, "", "names should be", "'#'"},
        {"one_reading", write(oedometer, "axial_stress_kPa,axial_strain\n10,0\n"), oedometer, 2, "",
         "only reading", "two readings"},
        {"column_twice", edit(oedometer, "phase,", "axial_strain,"), oedometer, 1, "axial_strain",
         "there twice", "remove or rename"},
        {"quantity_twice", edit(oedometer, "phase,", "axial_strain_percent,"), oedometer, 1, "axial_strain",
         "same quantity as column 'axial_strain_percent'", "keep one"},
        {"row_too_short", edit(oedometer, "loading,40,0.01", "loading,40"), oedometer, 4, "",
         "2 cells where the header names 3", "add the missing"},
        {"row_too_long", edit(oedometer, "loading,40,0.01", "loading,40,0,01"), oedometer, 4, "",
         "4 cells where the header names 3", "decimal comma"},
        {"stray_quote", edit(oedometer, "loading,40", "loading,4\"0"), oedometer, 4, "", "quotation mark",
         "leave them out"},
        {"open_quote", edit(oedometer, "loading,40", "\"loading,40"), oedometer, 4, "", "quotation mark",
         "close it"},
        {"binary_file", write(oedometer, std::string("axial\n\0\x01\x02", 9)), oedometer, 2, "", "binary",
         "text file"},
        {"latin_1", edit(oedometer, "loading,40", "charg\xe9,40"), oedometer, 4, "", "not UTF-8", "UTF-8"},
        {"utf_16",
         write(oedometer, std::string("\xff\xfe"
                                      "a\0",
                                      4)),
         oedometer, 1, "", "UTF-16", "CSV UTF-8"},
        {"workbook", write(oedometer, "PK\x03\x04..."), oedometer, 0, "", "workbook",
         "export the sheet as CSV"},
        {"too_many_columns",
         [](Files& f) {
             std::string line = "c0";
             for (int i = 1; i <= 1000; ++i) line += ",c" + std::to_string(i);
             f[oedometer] = line + "\n" + line + "\n";
         },
         oedometer, 1, "", "1001 columns", "readings into rows"},
        {"huge_file", write(oedometer, std::string(17 << 20, '1')), oedometer, 0, "", "bytes; the most is",
         "thin"},
    };
}

std::vector<Case> column_cases() {
    return {
        {"misspelt_column", edit(oedometer, "axial_strain", "axial_strian"), oedometer, 1, "axial_strain",
         "is missing", "did you mean column 'axial_strian'?"},
        {"other_case_and_brackets", edit(oedometer, "axial_stress_kPa", "Axial stress (kPa)"), oedometer, 1,
         "axial_stress", "is missing", "Name it 'axial_stress_kPa'"},
        {"missing_column", edit(triaxial, "volumetric_strain_percent", "pore_pressure"), triaxial, 1,
         "volumetric_strain", "is missing", "volumetric_strain or volumetric_strain_percent"},
        {"missing_either_column", edit(shear, "shear_displacement_mm", "time_s"), shear, 1,
         "shear_displacement", "is missing", "or else shear_strain"},
        {"unknown_separator", write(oedometer, "axial_stress_kPa|axial_strain\n10|0\n20|0.1\n"), oedometer, 1,
         "axial_stress", "is missing", "separated by comma, semicolon or tab"},
        {"unknown_unit", edit(oedometer, "axial_stress_kPa", "axial_stress_psi"), oedometer, 1,
         "axial_stress_psi", "unit 'psi', which is not known",
         "axial_stress_kPa, axial_stress_Pa or axial_stress_MPa"},
        {"unit_in_other_case", edit(oedometer, "axial_stress_kPa", "axial_stress_KPA"), oedometer, 1,
         "axial_stress_KPA", "not known", "did you mean 'axial_stress_kPa'?"},
        {"no_unit", edit(oedometer, "axial_stress_kPa", "axial_stress"), oedometer, 1, "axial_stress",
         "has no unit", "name it axial_stress_kPa"},
        {"unit_of_another_quantity", edit(oedometer, "axial_strain", "axial_strain_kPa"), oedometer, 1,
         "axial_strain_kPa", "does not fit", "axial_strain_percent"},
        {"optional_with_unknown_unit", edit(shear, "normal_stress_kPa", "normal_stress_bar"), shear, 1,
         "normal_stress_bar", "not known", "normal_stress_kPa"},
        {"displacement_and_strain", edit(shear, "normal_stress_kPa", "shear_strain"), shear, 1,
         "shear_strain", "same quantity as column 'shear_displacement_mm'", "keep one"},
        {"text_for_number", edit(oedometer, "0.01\n", "abc\n"), oedometer, 4, "axial_strain",
         "must be a number", "0.0125"},
        {"decimal_comma", edit(oedometer, "0.01\n", "\"0,01\"\n"), oedometer, 4, "axial_strain",
         "must be a number", "write 0.01"},
        {"decimal_comma_with_semicolons",
         write(oedometer, "axial_stress_kPa;axial_strain_percent\n10;0\n20;0,4\n40;1,5\n"), oedometer, 3,
         "axial_strain_percent", "must be a number", "write 0.4"},
        {"empty_cell", edit(oedometer, "0.01\n", "\n"), oedometer, 4, "axial_strain", "is empty",
         "whole row out"},
        {"not_a_number", edit(triaxial, "180", "nan"), triaxial, 4, "deviatoric_stress_kPa",
         "must be a number", "whole row out"},
        {"infinite", edit(triaxial, "180", "inf"), triaxial, 4, "deviatoric_stress_kPa", "must be a number",
         "number"},
        {"hexadecimal", edit(triaxial, "180", "0xB4"), triaxial, 4, "deviatoric_stress_kPa",
         "must be a number", ""},
        {"too_large_for_a_double", edit(triaxial, "180", "1e400"), triaxial, 4, "deviatoric_stress_kPa",
         "must be a number", ""},
        {"unit_in_cell", edit(triaxial, "180", "180 kPa"), triaxial, 4, "deviatoric_stress_kPa",
         "must be a number", "write 180"},
    };
}

std::vector<Case> meaning_cases() {
    return {
        {"strain_in_percent", write(oedometer, "axial_stress_kPa,axial_strain\n10,0\n20,0.9\n40,1.7\n"),
         oedometer, 4, "axial_strain", "beyond 1", "name it axial_strain_percent"},
        {"triaxial_strain_in_percent", edit(triaxial, "axial_strain_percent", "axial_strain"), triaxial, 4,
         "axial_strain", "beyond 1", "name it axial_strain_percent"},
        {"strain_beyond_all", edit(triaxial, "5,210", "120,210"), triaxial, 6, "axial_strain_percent",
         "beyond 100 %", "correct"},
        {"strain_in_percent_by_void_ratio",
         write(oedometer,
               "axial_stress_kPa,axial_strain,void_ratio\n10,0,0.8\n20,0.3,0.7946\n40,0.6,0.7892\n"),
         oedometer, 4, "axial_strain", "hundred times", "axial_strain_percent"},
        {"runs_backwards", write(oedometer, "axial_stress_kPa,axial_strain\n10,0.03\n20,0.02\n40,0.01\n"),
         oedometer, 4, "axial_strain", "most of the column falls", "order of the test"},
        {"strain_jumps_back", edit(oedometer, "loading,160,0.035", "loading,160,0.0035"), oedometer, 8,
         "axial_strain", "by more than noise", "correct the value"},
        {"strain_rises_in_unloading", edit(oedometer, "20,0.018", "20,0.18"), oedometer, 6, "axial_strain",
         "rises while unloading", "correct the value"},
        {"no_strain", write(oedometer, "axial_stress_kPa,axial_strain\n10,0\n20,0\n40,0\n"), oedometer, 2,
         "axial_strain", "not positive", "strain of each stage"},
        {"beyond_its_pores", edit(oedometer, "160,0.035", "160,0.45"), oedometer, 8, "axial_strain",
         "leaves no pores: an initial void ratio of 0.8 allows a strain of 0.444", "check the unit"},
        {"negative_void_ratio",
         write(oedometer, "axial_stress_kPa,axial_strain,void_ratio\n10,0,0.8\n20,0.01,-0.8\n"), oedometer, 3,
         "void_ratio", "above 0", "volume of pores"},
        {"triaxial_jumps_back", edit(triaxial, "1.95,181", "-1.95,181"), triaxial, 5, "axial_strain_percent",
         "by more than noise", "correct the value"},
        {"strain_falls_in_phase", edit(oedometer, "loading,40,0.01", "loading,15,0.01"), oedometer, 4,
         "axial_stress_kPa", "does not rise while loading", "correct the phase"},
        {"stress_repeated_in_phase", edit(oedometer, "loading,40,0.01", "loading,20,0.01"), oedometer, 4,
         "axial_stress_kPa", "does not rise while loading", "last reading of each stage"},
        {"stress_rises_in_unloading", edit(oedometer, "unloading,20", "unloading,90"), oedometer, 6,
         "axial_stress_kPa", "does not fall while unloading", "correct the phase"},
        {"stress_falls_without_phase",
         write(oedometer, "axial_stress_kPa,axial_strain\n10,0\n20,0.1\n15,0.1\n"), oedometer, 4,
         "axial_stress_kPa", "does not rise", "add a column phase"},
        {"stress_constant", write(oedometer, "axial_stress_kPa,axial_strain\n10,0\n10,0.1\n"), oedometer, 3,
         "axial_stress_kPa", "does not rise", "last reading of each stage"},
        {"unknown_phase", edit(oedometer, "unloading", "unload"), oedometer, 6, "phase",
         "loading, unloading or reloading", "did you mean 'unloading'?"},
        {"begins_with_unloading", edit(oedometer, "loading,10", "unloading,10"), oedometer, 2, "phase",
         "first phase", "begins with loading"},
        {"zero_stress", edit(oedometer, "loading,10", "loading,0"), oedometer, 2, "axial_stress_kPa",
         "above 0", "seating_stress_kPa"},
        {"stress_of_another_unit", edit(oedometer, "loading,160,", "loading,1.6e9,"), oedometer, 8,
         "axial_stress_kPa", "beyond 1 GPa", "unit"},
        {"compression_negative", write(oedometer, "axial_stress_kPa,axial_strain\n10,0\n20,-0.1\n"),
         oedometer, 3, "axial_strain", "negative at the highest stress", "reverse the sign"},
        {"seating_above_first_stage", edit(toml, "initial_void_ratio = 0.8", "seating_stress_kPa = 12"),
         oedometer, 2, "axial_stress_kPa", "below the stated seating stress", "lower seating_stress_kPa"},
        {"triaxial_compression_negative",
         write(triaxial, "axial_strain,deviatoric_stress_kPa,volumetric_strain\n0,0,0\n-0.1,100,0\n"),
         triaxial, 3, "axial_strain", "negative at the end", "reverse the sign"},
        {"triaxial_without_stress",
         write(triaxial, "axial_strain,deviatoric_stress_kPa,volumetric_strain\n0,0,0\n0.1,-100,0\n"),
         triaxial, 2, "deviatoric_stress_kPa", "not positive", "reverse the sign"},
        {"displacement_beyond_box", edit(shear, "\n6,62", "\n66,62"), shear, 5, "shear_displacement_mm",
         "beyond the box's length", "unit"},
        {"settlement_beyond_box", edit(shear, "6,62,-0.2", "6,62,-30"), shear, 5, "settlement_mm",
         "beyond the box's height", "unit"},
        {"shear_backwards",
         write(shear, "shear_displacement_mm,shear_stress_kPa,settlement_mm\n-1,-2,0\n-2,-3,0\n"), shear, 2,
         "shear_displacement_mm", "not positive", "reverse the sign"},
        {"passing_over_100", edit(grading, "2,100", "2,110"), grading, 2, "passing_percent", "0 to 100 %",
         "passing"},
        {"passing_falls", edit(grading, "0.5,10", "0.5,70"), grading, 3, "passing_percent",
         "less than what passes", "not what it retains"},
        {"sieve_twice", edit(grading, "0.5,", "1,"), grading, 4, "sieve_mm", "there twice",
         "one row for each sieve"},
        {"sieve_zero", edit(grading, "0.5,", "0,"), grading, 4, "sieve_mm", "above 0", "opening"},
    };
}

class Malformed : public testing::TestWithParam<Case> {};

TEST_P(Malformed, IsAnsweredWithFileLineAndRemedy) {
    const Case& spoilt = GetParam();
    Files files = sound_files();
    spoilt.spoil(files);
    const TemporaryFolder folder;
    write_all(folder, files);
    try {
        read_sample(folder.path());
        FAIL() << "was read";
    } catch (const UserError& error) {
        SCOPED_TRACE(error.what());
        EXPECT_EQ(error.file(), (folder.path() / spoilt.file).string());
        EXPECT_EQ(error.line(), spoilt.line);
        EXPECT_EQ(error.column(), spoilt.column);
        EXPECT_NE(std::string(error.what()).find(spoilt.words), std::string::npos);
        EXPECT_NE(error.remedy().find(spoilt.remedy), std::string::npos);
        EXPECT_FALSE(error.remedy().empty());
    }
}

std::string case_name(const testing::TestParamInfo<Case>& info) {
    return info.param.name;
}
INSTANTIATE_TEST_SUITE_P(Toml, Malformed, testing::ValuesIn(toml_cases()), case_name);
INSTANTIATE_TEST_SUITE_P(Table, Malformed, testing::ValuesIn(table_cases()), case_name);
INSTANTIATE_TEST_SUITE_P(Columns, Malformed, testing::ValuesIn(column_cases()), case_name);
INSTANTIATE_TEST_SUITE_P(Meaning, Malformed, testing::ValuesIn(meaning_cases()), case_name);

TEST(MalformedPath, PipesAreNotWaitedFor) {
    const TemporaryFolder folder;
    Files files = sound_files();
    files.erase(oedometer);
    write_all(folder, files);
    ASSERT_EQ(mkfifo((folder.path() / oedometer).c_str(), 0600), 0);
    EXPECT_THROW(read_sample(folder.path()), UserError);
}

TEST(MalformedPath, MissingFolderOffersTheNearestName) {
    const TemporaryFolder folder;
    folder.write("dobrany_sand/sample.toml", "");
    try {
        read_sample(folder.path() / "dobrani_sand");
        FAIL();
    } catch (const UserError& error) {
        EXPECT_EQ(error.file(), (folder.path() / "dobrani_sand").string());
        EXPECT_NE(error.remedy().find("'dobrany_sand'"), std::string::npos);
    }
}

}  // namespace
}  // namespace loam::lab_data
