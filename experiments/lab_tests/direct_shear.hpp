// The virtual direct shear test in a box of rigid walls in two halves: loading by a platen, then the upper
// half moves at constant speed under constant normal stress.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "engine/box.hpp"
#include "engine/loading.hpp"
#include "engine/simulation.hpp"
#include "engine/wall_servo.hpp"
#include "experiments/lab_tests/registry.hpp"

namespace loam::experiments {

struct PlatenPressure {
    double displacement = 0;   // over the box's length
    double normal_stress = 0;  // Pa
};

struct DirectShearOptions {
    double normal_stress = 1e5;  // Pa, of the platen, over the box's plan
    // What it presses with while the box is sheared, where other than that: by rising displacement, linear
    // between.
    std::vector<PlatenPressure> pressures;
    std::vector<double> displacements;  // of the upper half over the box's length, rising: where it is read
    double wall_friction_angle = 0;     // rad, of all walls against particles
    double gap = 0;                     // between the halves, over the mean diameter
    // Sets the speed: of the shear rate over ten diameters, or the height where that is less (a shear zone is
    // some ten grains thick), under the normal stress.
    double inertial_number = 1e-3;
    double strain_per_step = 1e-6;  // the rate is not lowered below this, so that rigid packings end in
                                    // reasonable time,
    double highest_inertial_number = 2e-3;  // unless the inertial number would pass this
    double isotropic_stress = 2000;         // Pa: the packing first rests under it with the law of the test
    double seating_stiffness = 0;           // as for the triaxial test (TriaxialOptions)
    engine::ServoOptions servo;             // of that rest
    // Of the platen's speed over the height while it loads, as of a strain rate under the normal stress. At
    // 5e-3 its momentum made boxes denser by 0.001 in porosity, and the first shear stress a fifth too high.
    double loading_inertial_number = 3e-4;
    engine::WallServoOptions platen;  // while the box is sheared

    void validate() const;  // throws std::invalid_argument
};

struct DirectShearReading {
    double displacement = 0;   // over the box's length
    double shear_stress = 0;   // along the displacement, of all walls of the moving half over the plan (Pa)
    double normal_stress = 0;  // of the platen, over the plan (Pa)
    // Of the platen's force, what the sides of the upper half take by friction: the plane of shear carries
    // one less this. Negative where particles under the edges push the upper half, which keeps its height,
    // upwards.
    double wall_share = 0;
    double settlement = 0;  // of the platen over the height at the start of shearing, positive down
    double void_ratio = 0;  // of the whole box
    double coordination_number = 0;
};

struct DirectShearResult {
    std::vector<DirectShearReading> readings;  // one for each of the displacements reached
    bool complete = false;
    std::string reason;          // why not complete
    double loaded_porosity = 0;  // of the whole box, at the start of shearing
    double height = 0;           // there (m)
    double loading_error = 0;    // relative, of the normal stress at the start of shearing
    // While the box is sheared:
    double largest_inertial_number = 0;
    double mean_unbalanced_ratio = 0;
    double mean_normal_error = 0;  // of the platen's pressure, relative
    double largest_normal_error = 0;
    double largest_overlap = 0;  // over R_i + R_j
    double energy_error = 0;     // of the energy balance
    std::uint64_t steps = 0;     // loading included
};

/// What is left of a test for pictures: see run_direct_shear.
using SimulationInspector = std::function<void(const engine::Simulation&)>;

/// Runs the test on a packing that lies between the walls of `box` (engine::make_boxed_packing), under those
/// simulation options. x is the direction of shear, z that of the normal stress; the halves meet at half the
/// height that the specimen has before it is loaded. Flanges close the openings that the displacement makes.
/// `cancelled` is polled and makes it throw std::runtime_error; `inspect` is given the simulation at the end.
DirectShearResult run_direct_shear(const engine::Packing& packing, const engine::Box& box,
                                   const engine::ContactLaw& law, const engine::SimulationOptions& how,
                                   const DirectShearOptions& options,
                                   const std::function<bool()>& cancelled = {},
                                   const SimulationInspector& inspect = {});

// The entries of the table of lab tests (registry.hpp). Readings as those of the triaxial test, over the
// displacement and with the peak of the shear stress among them.
std::vector<std::size_t> direct_shear_readings(const lab_data::Test& test);
/// What the platen pressed with while the box was sheared, where that was recorded and is what the test says
/// but for a servo's lag (20 %): the strength is in proportion to it. Else nothing.
std::vector<PlatenPressure> measured_pressures(const lab_data::Test& test);
/// A box as long, wide and high as the measured one in particles, where the sample's grading says how large
/// they are and it is not too many; else one of the same proportions. Throws lab_data::UserError where that
/// takes more particles than a specimen can have, or the box is shorter than ten of them.
SpecimenShape direct_shear_specimen(const Settings& settings, const lab_data::Sample& sample,
                                    const lab_data::Test& test, double porosity, std::uint32_t particles);
VirtualTestResult run_measured_direct_shear(const Specimen& specimen, const engine::ContactLaw& law,
                                            const Settings& settings, double grain_density,
                                            const lab_data::Test& test,
                                            const std::function<bool()>& cancelled);
/// At the end of the displacement that was measured.
PictureOfTest picture_of_direct_shear(const Specimen& specimen, const engine::ContactLaw& law,
                                      const Settings& settings, double grain_density,
                                      const lab_data::Test& test);

}  // namespace loam::experiments
