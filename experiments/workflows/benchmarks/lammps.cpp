// LAMMPS as one of the other codes.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <stdexcept>

#include "experiments/workflows/benchmarks/other_codes.hpp"
#include "lab_data/number.hpp"

namespace loam::experiments {
namespace {

constexpr double pi = 3.14159265358979323846;

/// The pair style with its numbers: K_n K_t gamma_n gamma_t x_mu dampflag (LAMMPS manual, pair_style gran).
/// The stiffness does not follow the radii there, so the linear one is that between mean particles; the
/// dashpots give them the restitution, at an overlap of a thousandth of the radius where that matters.
std::string pair_style(const SharedWork& work) {
    const SharedParameters& p = work.parameters;
    const double radius = work.packing.radii.mean();
    const double reduced_mass = 2.0 / 3.0 * pi * work.grain_density * std::pow(radius, 3);
    const double loss = -std::log(p.restitution);
    const double damping = loss / std::hypot(pi, loss);  // over the critical
    double normal = p.young_modulus * radius, shear = p.stiffness_ratio * normal;
    double viscous = 2 * damping * std::sqrt(normal / reduced_mass);
    std::string_view style = "gran/hooke/history";
    if (work.law == SharedLaw::hertz) {
        style = "gran/hertz/history";
        normal = 2.0 / 3.0 * p.young_modulus / (1 - p.poisson_ratio * p.poisson_ratio);
        shear = 2 * p.young_modulus / ((1 + p.poisson_ratio) * (2 - p.poisson_ratio));
        const double contact_radius = radius * std::sqrt(0.5 * 1e-3);
        viscous = 2 * damping * std::sqrt(1.5 * normal / (reduced_mass * contact_radius));
    }
    return fmt::format("{} {} {} {} NULL {} 1", style, normal, shear, viscous, std::tan(p.friction_angle));
}

// Atoms are sorted every 1000 steps (the default), without which 10,000 take half as long again; newton on,
// and lists looked after at every step but made anew only when needed.
constexpr std::string_view lammps_script = R"in(units si
atom_style sphere
boundary p p p
newton on
comm_modify mode single vel yes
read_data packing.lmp
neighbor {skin} bin
neigh_modify delay 0 every 1 check yes one 500 page 50000
pair_style {pair_style}
pair_coeff * *
timestep {time_step}
fix motion all nve/sphere
fix load all deform 1 z erate -{strain_rate} remap v units box
velocity all ramp vz 0 {top_velocity} z 0 {height} units box
compute touching all contact/atom
compute contacts all reduce sum c_touching
thermo 0
run {warm_up}
run {steps}
thermo_style custom step c_contacts
run 0
print "loam-bench contacts $(0.5*c_contacts)"
)in";

void write_data(const SharedWork& work, const std::filesystem::path& file) {
    const engine::Packing& packing = work.packing;
    std::ofstream out(file);
    out << fmt::format("packing\n\n{} atoms\n1 atom types\n", packing.radii.size());
    for (int axis = 0; axis < 3; ++axis)
        out << fmt::format("0 {} {}lo {}hi\n", packing.cell(axis, axis), "xyz"[axis], "xyz"[axis]);
    out << "\nAtoms # sphere\n\n";
    for (Eigen::Index k = 0; k < packing.radii.size(); ++k)
        out << fmt::format("{} 1 {} {} {} {} {}\n", k + 1, 2 * packing.radii[k], work.grain_density,
                           packing.centres(0, k), packing.centres(1, k), packing.centres(2, k));
    if (!out.flush()) throw std::runtime_error(file.string() + " cannot be written");
}

/// The number between the last occurrence of `before` at or after `from` and the next `after`.
std::optional<double> number_between(std::string_view text, std::string_view before, std::string_view after) {
    const std::size_t start = text.find(before);
    if (start == std::string_view::npos) return std::nullopt;
    text.remove_prefix(start + before.size());
    return lab_data::parse_number(text.substr(0, text.find(after)));
}

}  // namespace

std::vector<std::string> write_lammps_input(const SharedWork& work, const std::filesystem::path& folder) {
    write_data(work, folder / "packing.lmp");
    const double height = work.packing.cell(2, 2);
    std::ofstream out(folder / "work.in");
    out << fmt::format(lammps_script, fmt::arg("skin", 0.15 * work.packing.radii.minCoeff()),
                       fmt::arg("pair_style", pair_style(work)), fmt::arg("time_step", work.time_step),
                       fmt::arg("strain_rate", work.strain_rate),
                       fmt::arg("top_velocity", -work.strain_rate * height), fmt::arg("height", height),
                       fmt::arg("warm_up", work.warm_up), fmt::arg("steps", work.steps));
    if (!out.flush()) throw std::runtime_error("the input of lammps cannot be written");
    return {"-log", "none", "-in", "work.in"};
}

std::optional<Timing> read_lammps_output(std::string_view output, const SharedWork& work) {
    // "Loop time of 1.5 on 1 procs for 1000 steps with 700 atoms", then "99.8% CPU use with 1 MPI tasks".
    const std::size_t line = output.rfind(fmt::format(" procs for {} steps ", work.steps));
    if (line == std::string_view::npos) return std::nullopt;
    const std::string_view report = output.substr(output.rfind("Loop time", line));
    const auto seconds = number_between(report, "Loop time of ", " on ");
    const std::size_t use = report.find("% CPU use");
    const auto contacts = said_number(output, "contacts");
    if (!seconds || !contacts || use == std::string_view::npos) return std::nullopt;
    const std::size_t before = report.rfind('\n', use);
    const auto share = lab_data::parse_number(report.substr(before + 1, use - before - 1));
    if (!share) return std::nullopt;
    return Timing{*seconds * *share / 100, *contacts};
}

}  // namespace loam::experiments
