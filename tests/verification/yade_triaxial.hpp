// Drained triaxial tests on packings of another DEM code, and how this engine's curves compare with that
// code's (data/yade/README.md).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "experiments/lab_tests/triaxial.hpp"
#include "experiments/specimens.hpp"

namespace loam::experiments {

/// A soil of the comparison; its curves are triaxial_NAME_N.csv.
struct YadeTriaxialCase {
    const char* name;
    bool free_rotation;
    engine::ContactLaw law;
    double time_step_safety = 0.7;
};

inline engine::LinearCohesive yade_linear(double friction_angle) {
    engine::LinearCohesive law;
    law.young_modulus = 1e8;
    law.stiffness_ratio = 0.83;
    law.friction_angle = friction_angle;
    law.normal_cohesion = law.shear_cohesion = 0;
    return law;
}

inline engine::ContactLaw yade_hertz() {
    engine::HertzMindlin law;
    law.young_modulus = 5e8;
    law.poisson_ratio = 0.3;
    law.friction_angle = 0.46;
    law.restitution = 0.5;
    return law;
}

inline engine::ContactLaw yade_rolling() {
    engine::ContactLaw law = yade_linear(0.46);
    law.rolling = {.friction = 0.15, .stiffness = 2};
    return law;
}

inline std::vector<YadeTriaxialCase> yade_triaxial_cases() {
    return {
        {"blocked", false, yade_linear(0.20)},
        {"rolling", true, yade_rolling()},
        {"free", true, yade_linear(0.46)},
        {"hertz", true, yade_hertz()},
    };
}

/// Deviatoric stress (Pa) and volumetric strain over axial strain.
struct TriaxialCurve {
    std::vector<double> strain, stress, volumetric;

    /// `y` at an axial strain, linear between readings.
    double at(const std::vector<double>& y, double x) const {
        const auto above = std::ranges::lower_bound(strain, x);
        if (above == strain.begin()) return y.front();
        if (above == strain.end()) return y.back();
        const auto k = static_cast<std::size_t>(above - strain.begin());
        return y[k - 1] + (x - strain[k - 1]) / (strain[k] - strain[k - 1]) * (y[k] - y[k - 1]);
    }
    double mean_stress(double from, double to) const {
        double sum = 0;
        constexpr int points = 200;
        for (int k = 0; k <= points; ++k) sum += at(stress, from + (to - from) * k / points);
        return sum / (points + 1);
    }
    /// From the start to half the peak.
    double initial_slope() const {
        const double half = 0.5 * *std::ranges::max_element(stress);
        std::size_t k = 1;
        while (stress[k] < half) ++k;
        const double share = (half - stress[k - 1]) / (stress[k] - stress[k - 1]);
        return half / (strain[k - 1] + share * (strain[k] - strain[k - 1]));
    }
};

inline std::string yade_folder() {
    return std::string(LOAM_SOURCE_DIR) + "/tests/verification/data/yade/";
}

/// `time_step`: of a curve with another time step than the case's, as its file's name says it.
inline TriaxialCurve read_yade_triaxial(const std::string& name, int packing,
                                        const std::string& time_step = "") {
    std::ifstream file(yade_folder() + "triaxial_" + name + "_" + std::to_string(packing) + time_step +
                       ".csv");
    EXPECT_TRUE(file) << name;
    TriaxialCurve curve;
    std::string line;
    std::getline(file, line);
    double strain = 0, axial = 0, lateral = 0, volumetric = 0;
    char comma = 0;
    while (file >> strain >> comma >> axial >> comma >> lateral >> comma >> volumetric) {
        curve.strain.push_back(strain);
        curve.stress.push_back(1000 * (axial - lateral));
        curve.volumetric.push_back(volumetric);
    }
    return curve;
}

/// The same test with this engine: isotropic 100 kPa, then 0.03 /s.
inline TriaxialCurve simulate_yade_triaxial(const YadeTriaxialCase& soil, int packing, double largest_strain,
                                            double time_step_safety) {
    TriaxialOptions options;
    options.strain_rate = 0.03;
    for (double strain = 0; strain < largest_strain + 1e-9; strain += 5e-4) options.strains.push_back(strain);
    engine::SimulationOptions how;
    how.free_rotation = soil.free_rotation;
    how.time_step_safety = time_step_safety;
    engine::Simulation simulation(load_packing(yade_folder() + "packing_" + std::to_string(packing) + ".csv"),
                                  soil.law, how);
    const TriaxialResult run = run_triaxial(simulation, soil.law, options);
    EXPECT_TRUE(run.complete) << run.reason;
    EXPECT_LT(run.consolidation_error, 0.01);
    EXPECT_LT(run.mean_lateral_error, 0.01);
    TriaxialCurve curve;
    for (const TriaxialReading& reading : run.readings) {
        curve.strain.push_back(reading.axial_strain);
        curve.stress.push_back(reading.deviatoric_stress);
        curve.volumetric.push_back(reading.volumetric_strain);
    }
    return curve;
}

}  // namespace loam::experiments
