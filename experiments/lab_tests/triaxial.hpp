// The virtual drained triaxial test in a periodic cell or a box of rigid walls: isotropic consolidation to
// the cell pressure, then axial compression at constant lateral stress.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "engine/loading.hpp"
#include "engine/simulation.hpp"
#include "experiments/lab_tests/registry.hpp"

namespace loam::experiments {

struct TriaxialOptions {
    double cell_pressure = 1e5;     // Pa
    std::vector<double> strains;    // axial, engineering, rising: where the test is read
    double inertial_number = 1e-3;  // sets the strain rate from the present mean stress
    double stress_change = 0.0015;  // largest change of the axial stress in one step, over the cell pressure
    double strain_per_step = 1e-6;  // the rate is not lowered below this, so that rigid packings end in
                                    // reasonable time,
    double highest_inertial_number = 2e-3;  // unless the inertial number would pass this
    double least_strain_per_step = 1e-7;    // nor for the change of stress below this
    double strain_rate = 0;                 // 1/s: when positive, used throughout instead
    // Consolidates first with a modulus of at most so many times the cell pressure, then with the true one,
    // as the oedometer seats (oedometer.hpp). 0: at once, for packings that were given.
    double seating_stiffness = 0;
    engine::ServoOptions servo;  // of the consolidation
    /// The normal stresses that are steered and read (Pa), e.g. the pressures on the walls of a box; without
    /// it Love-Weber's. The servos' own are replaced by it.
    std::function<Eigen::Vector3d(const engine::Simulation&)> stress_of = {};
    // Of the lateral stress while the specimen is compressed; never slower than the compression needs.
    engine::ServoOptions lateral{.inertial_number = 2e-2, .relaxation_steps = 60, .measure_every = 5};

    void validate() const;  // throws std::invalid_argument
};

struct TriaxialReading {
    double axial_strain = 0;       // engineering, from the height after consolidation
    double deviatoric_stress = 0;  // axial minus mean lateral stress (Pa)
    double volumetric_strain = 0;  // from the volume after consolidation, compression positive
    double void_ratio = 0;
    double coordination_number = 0;
};

struct TriaxialResult {
    std::vector<TriaxialReading> readings;  // one for each of the strains reached
    bool complete = false;
    std::string reason;  // why not complete
    double consolidated_porosity = 0;
    double consolidation_error = 0;  // largest relative stress error of an axis after consolidation
    // While the specimen is compressed:
    double largest_inertial_number = 0;
    double mean_unbalanced_ratio = 0;
    double mean_lateral_error = 0;  // of both lateral stresses, over the cell pressure
    double largest_lateral_error = 0;
    double largest_overlap = 0;  // over R_i + R_j
    double energy_error = 0;     // of the energy balance, where the simulation keeps one
    std::uint64_t steps = 0;     // consolidation included
    std::uint64_t consolidation_steps = 0;
};

/// Runs the test on the simulation, which must hold the packing with the contact parameters of the test; z is
/// the axis. `cancelled` is polled and makes it throw std::runtime_error.
TriaxialResult run_triaxial(engine::Simulation& simulation, const engine::ContactLaw& law,
                            const TriaxialOptions& options, const std::function<bool()>& cancelled = {});

// The entries of the table of lab tests (registry.hpp). Readings are chosen by spread_readings over axial
// strain, with the peak of the deviatoric stress among them. The specimen is a periodic cell, or a cube of
// walls where the settings say so.
std::vector<std::size_t> triaxial_readings(const lab_data::Test& test);
SpecimenShape triaxial_specimen(const Settings& settings, const lab_data::Sample& sample,
                                const lab_data::Test& test, double porosity, std::uint32_t particles);
VirtualTestResult run_measured_triaxial(const Specimen& specimen, const engine::ContactLaw& law,
                                        const Settings& settings, double grain_density,
                                        const lab_data::Test& test, const std::function<bool()>& cancelled);

/// Under the peak deviatoric stress that was measured.
PictureOfTest picture_of_triaxial(const Specimen& specimen, const engine::ContactLaw& law,
                                  const Settings& settings, double grain_density, const lab_data::Test& test);

}  // namespace loam::experiments
