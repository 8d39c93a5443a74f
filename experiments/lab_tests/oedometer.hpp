// The virtual oedometer: zero lateral strain, axial stress through given stages, strain read where each stage
// ends.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "engine/loading.hpp"
#include "engine/simulation.hpp"
#include "experiments/lab_tests/registry.hpp"

namespace loam::experiments {

struct OedometerOptions {
    double isotropic_stress = 2000;   // Pa: the packing is brought to this stress first
    double seating_stress = 2000;     // Pa: axial stress where strain is zero; reached at zero lateral strain
    std::vector<double> stages;       // Pa, in order; a stage below the one before it is unloading
    double inertial_number = 3.5e-4;  // sets the strain rate from the present stress
    double stress_change = 0.0015;    // largest relative change of the axial stress in one step
    double strain_per_step = 4e-7;    // the rate is not lowered below this, so that rigid packings end in
                                      // reasonable time,
    double highest_inertial_number = 2e-3;  // unless the inertial number would pass this
    double least_strain_per_step = 8e-8;    // nor for the change of stress below this: rigid packings stick
                                            // and slip
    double strain_rate = 0;  // 1/s: when positive, used throughout instead, and no stage is held
    // Every stage is held at its stress until the packing is at rest, as a laboratory does: what inertia
    // bears at the moment of passing is not read as strength. The way there still depends a little on the
    // rate.
    engine::ServoOptions hold{
        .inertial_number = 3.5e-4, .stress_tolerance = 0.004, .unbalanced_ratio = 0.01, .max_steps = 200'000};
    int measure_every = 10;        // steps between looks at the stress and the rate
    double largest_strain = 0.45;  // a run beyond it is out of range: the cell gets too flat
    // Seats first with a modulus of at most so many times the isotropic stress, then with the true one: in
    // the limit of rigid grains the packing is the same and the way there much shorter. 0: at once, for
    // packings that were given.
    double seating_stiffness = 0;
    bool record_path = false;  // keep the whole curve
    engine::ServoOptions servo;

    void validate() const;  // throws std::invalid_argument
};

struct OedometerResult {
    Eigen::VectorXd strain;  // [stages], axial, engineering, since seating; NaN where not reached
    bool complete = false;
    std::string reason;  // why not complete
    double seated_porosity = 0;
    double initial_height = 0;           // of the cell at seating (m)
    double seating_error = 0;            // largest relative stress error of an axis after isotropic seating
    double largest_inertial_number = 0;  // during loading
    double mean_unbalanced_ratio = 0;    // during loading
    double largest_overlap = 0;          // over R_i + R_j
    double energy_error = 0;             // of the energy balance, where the simulation keeps one
    std::uint64_t steps = 0;             // seating included
    std::uint64_t seating_steps = 0;
    std::vector<double> path_strain, path_axial, path_lateral;  // with record_path
};

/// Runs the test on the simulation, which must hold the packing with the contact parameters of the test.
/// Source of the procedure: De Pue et al. 2019, section 2.2.2. `cancelled` is polled and makes it throw
/// std::runtime_error.
OedometerResult run_oedometer(engine::Simulation& simulation, const engine::ContactLaw& law,
                              const OedometerOptions& options, const std::function<bool()>& cancelled = {});

// The entries of the table of lab tests (registry.hpp). The reading at the seating stress, where strain is
// zero by definition, is not simulated; of a phase with more than 40 readings 40 are used, evenly spread over
// log stress.
std::vector<std::size_t> oedometer_readings(const lab_data::Test& test);
VirtualTestResult run_measured_oedometer(const Specimen& specimen, const engine::ContactLaw& law,
                                         const Settings& settings, double grain_density,
                                         const lab_data::Test& test, const std::function<bool()>& cancelled);

PictureOfTest picture_of_oedometer(const Specimen& specimen, const engine::ContactLaw& law,
                                   const Settings& settings, double grain_density,
                                   const lab_data::Test& test);

}  // namespace loam::experiments
