// What the benchmarks on synthetic soils share: tests that are to be simulated, and their measurements.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "experiments/observation.hpp"
#include "lab_data/sample.hpp"

namespace loam::experiments {

/// Streams of run_seed: the packings of synthetic soils, their measurements' noise, and which soils.
inline constexpr std::uint64_t twin_packings = 21, twin_noise = 22, twin_design = 23;
/// Where their runs lie in the ensemble.
inline constexpr std::uint64_t twins_from = 4'000'000;

/// A test with so many readings, denser at the start, up to x = `to` (SI), whose channels are 0.
lab_data::Test test_without_readings(lab_data::TestKind kind, std::string file, const char* x, double to,
                                     int readings, std::initializer_list<const char*> channels);

/// An oedometer test with these stages (Pa), of which one below that before it is unloading, and strains of
/// 0.
lab_data::Test oedometer_without_readings(double seating_stress, std::initializer_list<double> stages);

/// The observation of a soil: its run's outputs with the noise that the observation's curves assume.
Observation observed(const Observation& form, const std::vector<Eigen::Index>& columns, const RunRecord& run,
                     std::uint64_t seed);

}  // namespace loam::experiments
