// The benchmarks that `loam bench` runs, one file each; the table stands in ../bench.cpp.
#pragma once

#include "experiments/settings/settings.hpp"
#include "lab_data/sample.hpp"

namespace loam::experiments {

/// Synthetic soils with known parameters, recovered from one shared ensemble: errors, floors and coverage.
int bench_twins(const Settings& settings);

/// Likewise from an oedometer, a triaxial and a direct shear test of each soil together.
int bench_joint_twins(const Settings& settings);

/// Blind twins with and without hidden effects, each diagnosed: how often the diagnosis is right.
int bench_diagnose(const Settings& settings);

/// What each effect does to the curves of each kind of test: a table, and a page of charts.
int bench_atlas(const Settings& settings);

/// The cost of a data set by the number of its samples.
int bench_bulk(const Settings& settings);

/// Oedometer runs at the default loading rate and at half of it: mean change of strain, stage by stage.
int bench_rate(const Settings& settings);

/// Particle-steps and contact-steps a second of the engine.
int bench_engine(const Settings& settings);

/// The same beside the codes of settings.against. Returns 1 if none of them is installed and runs.
int bench_engine_against(const Settings& settings);

/// The oedometer of De Pue et al. (2019): their eight stages, seated at 2 kPa, as a sample without measured
/// strain.
lab_data::Sample reference_sample();

}  // namespace loam::experiments
