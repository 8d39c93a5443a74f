// A small sound sample with one test of each kind, written to a folder of its own, for tests to spoil.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

namespace loam::lab_data {

/// A new empty folder that goes away with the object.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        // In memory where there is such a thing: some tests write thousands of files.
        const bool shared_memory = access("/dev/shm", W_OK) == 0;
        const std::filesystem::path parent =
            shared_memory ? "/dev/shm" : std::filesystem::temp_directory_path();
        std::string pattern = (parent / "loam-lab-data-XXXXXX").string();
        if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
        path_ = pattern;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() { std::filesystem::remove_all(path_); }

    const std::filesystem::path& path() const { return path_; }

    void write(const std::string& file, const std::string& text) const {
        std::filesystem::create_directories((path_ / file).parent_path());
        std::ofstream(path_ / file, std::ios::binary) << text;
    }

  private:
    std::filesystem::path path_;
};

inline std::string read_whole(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

/// `text` with its first `from` replaced; it must be there, else the test would test nothing.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    if (at == std::string::npos) throw std::logic_error("'" + from + "' is not in the file");
    return text.replace(at, from.size(), to);
}

using Files = std::map<std::string, std::string>;

inline Files sound_files() {
    return {{"sample.toml",
             "name = \"test-sand\"\n"        // 1
             "source = \"made up\"\n"        // 2
             "licence = \"CC0-1.0\"\n"       // 3
             "measured = false\n"            // 4
             "[soil]\n"                      // 5
             "grain_density_kg_m3 = 2650\n"  // 6
             "grading = \"grading.csv\"\n"   // 7
             "[soil.properties]\n"           // 8
             "clay_kg_kg = 0.02\n"           // 9
             "origin = \"river\"\n"          // 10
             "[[test]]\n"                    // 11
             "kind = \"oedometer\"\n"        // 12
             "file = \"oedometer.csv\"\n"    // 13
             "initial_void_ratio = 0.8\n"    // 14
             "[[test]]\n"                    // 15
             "kind = \"triaxial\"\n"         // 16
             "file = \"triaxial.csv\"\n"     // 17
             "cell_pressure_kPa = 100\n"     // 18
             "[[test]]\n"                    // 19
             "kind = \"direct_shear\"\n"     // 20
             "file = \"shear.csv\"\n"        // 21
             "normal_stress_kPa = 100\n"     // 22
             "box_length_mm = 60\n"          // 23
             "box_height_mm = 25\n"},        // 24
            {"grading.csv", "sieve_mm,passing_percent\n2,100\n1,60\n0.5,10\n"},
            {"oedometer.csv",
             "phase,axial_stress_kPa,axial_strain\n"  // 1
             "loading,10,0\n"                         // 2
             "loading,20,0.004\n"                     // 3
             "loading,40,0.01\n"                      // 4
             "loading,80,0.02\n"                      // 5
             "unloading,20,0.018\n"                   // 6
             "reloading,80,0.021\n"                   // 7
             "loading,160,0.035\n"},                  // 8
            {"triaxial.csv",
             "axial_strain_percent,deviatoric_stress_kPa,volumetric_strain_percent\n"
             "0,0,0\n1,120,0.3\n2,180,0.2\n1.95,181,0.1\n5,210,-0.8\n"},
            {"shear.csv",
             "shear_displacement_mm,shear_stress_kPa,settlement_mm,normal_stress_kPa\n"
             "0,0,0,100\n0.5,30,0.1,99\n1.5,55,0.05,101\n6,62,-0.2,100\n"}};
}

inline void write_all(const TemporaryFolder& folder, const Files& files) {
    for (const auto& [name, text] : files) folder.write(name, text);
}

}  // namespace loam::lab_data
