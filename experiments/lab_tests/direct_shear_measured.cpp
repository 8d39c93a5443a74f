// The direct shear test of a sample: from the readings of lab_data::Test to the virtual test and back.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/density.hpp"
#include "experiments/lab_tests/direct_shear.hpp"
#include "experiments/lab_tests/measured.hpp"
#include "experiments/lab_tests/readings.hpp"
#include "experiments/preparation_stiffness.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

constexpr double largest_displacement = 0.4;  // over the box's length
constexpr double fewest_diameters = 10;       // along the box, below which it is the walls that are measured
constexpr double usual_length = 14, least_height = 6;  // of made boxes, in diameters
constexpr double longest = 20;    // of a box that is made as it was measured, in diameters
constexpr double most_lag = 0.2;  // of the recorded normal stress, beyond which it is not that of the plane
constexpr std::uint32_t usual_particles = 700;
constexpr double most_particles = 2e6;  // of any specimen

/// Diameter of the mean particle of a specimen whose median size by mass is that of the grading (m); 0 where
/// no grading is stated.
double mean_diameter(const lab_data::Sample& sample, double spread) {
    // Radii uniform by number: mass up to r goes with r^4.
    const double low = std::pow(1 - spread, 4), high = std::pow(1 + spread, 4);
    return median_grain_size(sample) / std::pow(0.5 * (low + high), 0.25);
}

/// Sides over the mean diameter.
Eigen::Vector3d box_in_diameters(const Settings& settings, const lab_data::Sample& sample,
                                 const lab_data::Test& test, std::uint32_t particles) {
    const Eigen::Vector3d sides(test.box_length, test.box_width, test.box_height);
    if (settings.direct_shear.box_diameters)
        return sides * (*settings.direct_shear.box_diameters / test.box_length);
    const double diameter = mean_diameter(sample, settings.specimen.size_spread);
    if (diameter > 0 && test.box_length / diameter <= longest) {
        if (test.box_length < fewest_diameters * diameter)
            throw lab_data::UserError(
                {.file = (sample.folder / "sample.toml").string(),
                 .column = "box_length_mm",
                 .value = fmt::format("{:.4g}", 1000 * test.box_length),
                 .constraint = fmt::format("is less than ten particles of {:.3g} mm, the size of the grading",
                                           1000 * diameter),
                 .remedy = "correct the box or the grading, or set direct_shear.box_diameters"});
        return sides / diameter;
    }
    const double size = std::cbrt(static_cast<double>(particles) / usual_particles);
    const double length = std::max(usual_length, least_height * test.box_length / test.box_height);
    return sides * (std::max(fewest_diameters, size * length) / test.box_length);
}

/// What is wrong is not the number but a side of the box, as a rule by its unit.
lab_data::UserError too_many_particles(double count, const Settings& settings, const lab_data::Sample& sample,
                                       const lab_data::Test& test) {
    return lab_data::UserError(
        {.file = (sample.folder / "sample.toml").string(),
         .column = "box_length_mm, box_width_mm, box_height_mm",
         .value = fmt::format("{:.6g}, {:.6g}, {:.6g}", 1000 * test.box_length, 1000 * test.box_width,
                              1000 * test.box_height),
         .constraint = fmt::format("make the specimen of {} one of {:.6g} particles, more than {:.0f}",
                                   test.file, count, most_particles),
         .remedy = settings.direct_shear.box_diameters
                       ? "correct the box, or lower direct_shear.box_diameters"
                       : "correct the box, or ask for fewer particles"});
}

DirectShearOptions direct_shear_options(const Settings& settings, const lab_data::Test& test) {
    DirectShearOptions options;
    options.normal_stress = test.normal_stress;
    options.pressures = measured_pressures(test);
    options.wall_friction_angle = test.wall_friction_angle;
    options.gap = settings.direct_shear.gap_diameters;
    options.isotropic_stress = std::min(1000 * settings.specimen.preparation_stress_kPa, test.normal_stress);
    options.seating_stiffness = preparation_stiffness;
    const double haste = settings.engine.haste;
    options.inertial_number =
        std::min(yielding_inertial_number_factor * haste * settings.engine.inertial_number,
                 options.highest_inertial_number);
    options.strain_per_step *= haste;
    for (const std::size_t k : direct_shear_readings(test))
        options.displacements.push_back(test.column("shear_displacement")[k] / test.box_length);
    return options;
}

}  // namespace

std::vector<PlatenPressure> measured_pressures(const lab_data::Test& test) {
    std::vector<PlatenPressure> out;
    if (!test.columns.contains("normal_stress")) return out;
    const auto& displacement = test.column("shear_displacement");
    const auto& pressure = test.column("normal_stress");
    for (std::size_t k = 0; k < pressure.size(); ++k) {
        if (std::abs(pressure[k] / test.normal_stress - 1) > most_lag) return {};
        const double x = displacement[k] / test.box_length;
        if (out.empty() || x > out.back().displacement) out.push_back({x, pressure[k]});
    }
    return out;
}

std::vector<std::size_t> direct_shear_readings(const lab_data::Test& test) {
    return spread_readings(test.column("shear_displacement"), test.column("shear_stress"),
                           largest_displacement * test.box_length);
}

SpecimenShape direct_shear_specimen(const Settings& settings, const lab_data::Sample& sample,
                                    const lab_data::Test& test, double porosity, std::uint32_t particles) {
    const Eigen::Vector3d sides = box_in_diameters(settings, sample, test, particles);
    const double spread = settings.specimen.size_spread;
    const double particle = std::numbers::pi / 6 * (1 + spread * spread);  // mean volume over diameter cubed
    const double count = std::round((1 - porosity) * sides.prod() / particle);
    if (!(count <= most_particles)) throw too_many_particles(count, settings, sample, test);
    return {static_cast<std::uint32_t>(std::max(100.0, count)), sides / sides.maxCoeff()};
}

VirtualTestResult run_measured_direct_shear(const Specimen& specimen, const engine::ContactLaw& law,
                                            const Settings& settings, double grain_density,
                                            const lab_data::Test& test,
                                            const std::function<bool()>& cancelled) {
    const DirectShearResult run = run_direct_shear(specimen.packing, specimen.box.value(), law,
                                                   simulation_options(settings, grain_density, true),
                                                   direct_shear_options(settings, test), cancelled);
    return result_of(
        run, std::max(run.loading_error, run.mean_normal_error), run.loaded_porosity,
        [](const DirectShearReading& at) { return at.shear_stress; },
        [&test](const DirectShearReading& at) { return at.settlement * test.box_height; });
}

PictureOfTest picture_of_direct_shear(const Specimen& specimen, const engine::ContactLaw& law,
                                      const Settings& settings, double grain_density,
                                      const lab_data::Test& test) {
    PictureOfTest picture;
    run_direct_shear(specimen.packing, specimen.box.value(), law,
                     simulation_options(settings, grain_density, false), direct_shear_options(settings, test),
                     {}, [&](const engine::Simulation& at_end) {
                         picture = {at_end.packing(), at_end.contacts(), test.normal_stress};
                     });
    return picture;
}

}  // namespace loam::experiments
