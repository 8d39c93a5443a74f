// Other DEM codes that `loam bench engine --against` measures on the work of this engine: their Debian
// packages, their input for the same packing, law and loading, and the time that they say they took.
// A further code is one file like yade.cpp and one line of the table in other_codes.cpp.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/packing.hpp"
#include "experiments/ensemble/stop_token.hpp"

namespace loam::experiments {

/// Laws that codes have in common, however they call them.
enum class SharedLaw {
    linear,    // springs, Coulomb friction
    cohesive,  // the same with normal and shear cohesion that breaks
    hertz      // Hertz and Mindlin without slip, Coulomb friction, viscous damping
};

/// The parameters of a shared law; those that it has not are left out.
struct SharedParameters {
    double young_modulus =
        3.1622776601683795e8;      // Pa: linear k_n = 2 E R1 R2/(R1 + R2); hertz: of the grains
    double stiffness_ratio = 0.4;  // linear, cohesive: k_t / k_n
    double poisson_ratio = 0.3;    // hertz
    double friction_angle = 0.31;  // rad
    double cohesion = 1e5;         // cohesive: Pa, normal and shear
    double restitution = 0.5;      // where a code damps contacts by dashpots
};

/// A packing at rest, its law, and how far it is compressed along z while the clock runs.
struct SharedWork {
    engine::Packing
        packing;  // orthogonal cell; neighbours near each other in the order, as all codes like it
    SharedLaw law = SharedLaw::linear;
    SharedParameters parameters;
    bool free_rotation = false;
    double grain_density = 2600;  // kg/m³
    double damping = 0.4;         // Cundall's, where the code has it
    double time_step = 0;         // s
    double strain_rate = 0;       // 1/s, compression positive
    int warm_up = 0, steps = 0;   // before the clock runs, and while it does
};

struct Timing {
    double seconds = 0;   // processor time of the steps
    double contacts = 0;  // at the end
};

/// What a code calls a law.
struct LawName {
    SharedLaw law;
    std::string_view name;
};

struct OtherCode {
    std::string_view name, program, package;
    std::span<const LawName> laws;
    std::vector<std::string> (*write_input)(const SharedWork&,
                                            const std::filesystem::path& folder);  // arguments
    std::optional<Timing> (*read_output)(std::string_view output, const SharedWork&);
};

std::span<const OtherCode> other_codes();

/// The code of that name, or nullptr.
const OtherCode* find_code(std::string_view name);

/// The code's own name of that law; empty if it has none.
std::string_view name_of_law(const OtherCode& code, SharedLaw law);

/// Runs `program`, which is that code, on the work in a temporary folder that goes with all in it. Throws
/// std::runtime_error with the last words of a code that fails, Interrupted when asked to stop.
Timing run_other_code(const OtherCode& code, const std::filesystem::path& program, const SharedWork& work,
                      const StopToken& stop);

/// The line by which a script of ours says a number: "loam-bench NAME VALUE". Nothing if there is none.
std::optional<double> said_number(std::string_view output, std::string_view name);

// The entries of the table.
std::vector<std::string> write_yade_input(const SharedWork& work, const std::filesystem::path& folder);
std::optional<Timing> read_yade_output(std::string_view output, const SharedWork& work);
std::vector<std::string> write_lammps_input(const SharedWork& work, const std::filesystem::path& folder);
std::optional<Timing> read_lammps_output(std::string_view output, const SharedWork& work);

}  // namespace loam::experiments
