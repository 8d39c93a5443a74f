// Every setting of a run, with its default. A run is described by this struct alone: it is filled from the
// defaults, then the configuration file, then the command line (experiments/settings/read.hpp), checked once,
// and written whole to RUN/config.toml. To add a setting: one member here and one row of the table in
// fields.cpp; reading, checking, writing, comparing and the command line follow from that row.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/contact/registry.hpp"

namespace loam::experiments {

/// The prior of one fitted parameter, in SI. `lognormal`: mean and sd are of log10 of the value. Truncated to
/// the bounds.
struct Prior {
    engine::PriorKind kind = engine::PriorKind::uniform;
    double mean = 0;  // unused (0) for uniform and loguniform
    double sd = 0;    // likewise
    double lower = 0;
    double upper = 0;
    bool operator==(const Prior&) const = default;
};

/// How a simulation is run.
struct EngineSettings {
    double damping = 0.4;             // Cundall's local damping, 0..1
    bool density_scaling = true;      // small particles as heavy as the mean one's time step demands, spins as slow
    double time_step_safety = 0.85;   // share of the time step that is still stable
    double inertial_number = 3.5e-4;  // target while loading: sets the strain rate
    double haste = 1;                 // rates of loading over the careful ones
    bool fragile = true;              // a cohesive bond, once broken, does not heal
    double interaction_range = 1.5;   // of the sum of radii: reach of a cohesive bond
    bool operator==(const EngineSettings&) const = default;
};

/// How a specimen is made.
struct SpecimenSettings {
    double size_spread = 0.3;                   // uniform grading: mean radius * (1 +- size_spread)
    std::optional<double> porosity;             // default: from the test's initial void ratio
    std::string match = "void_ratio";           // what is taken from that: void_ratio | relative_density
    std::optional<double> grain_density_kg_m3;  // default: the sample's
    double preparation_stress_kPa = 2;
    bool operator==(const SpecimenSettings&) const = default;
};

/// How triaxial tests are run.
struct TriaxialSettings {
    std::string boundary = "periodic";  // periodic | walls: a cube of six rigid ones
    bool operator==(const TriaxialSettings&) const = default;
};

/// How direct shear tests are run.
struct DirectShearSettings {
    std::optional<double> box_diameters;  // length of the box over the mean diameter; default: as measured
                                          // where the grading tells and it is not too long
    double gap_diameters = 0;             // between the halves of the box
    bool operator==(const DirectShearSettings&) const = default;
};

/// How parameters are fitted.
struct CalibrationSettings {
    std::string design = "latin-hypercube";
    bool narrowing = true;  // of the first runs: a third over the prior, the rest where that leaves plausible
    std::string kernel = "matern52";
    std::string global_optimizer = "crs2";
    int replicates = 8;              // further packings at chosen points, from which packing noise is learnt
    int confirmation_packings = 12;  // fresh packings for the direct runs at the estimate
    int max_rounds = 4;              // rounds of runs added where emulator and direct runs disagree
    int runs_per_round = 24;
    int posterior_draws = 4000;
    int specimen_particles = 0;  // in the measured specimen, which scatters like such a packing; 0: countless
                                 // in a measured soil, as many as in the runs in a synthetic one
    bool operator==(const CalibrationSettings&) const = default;
};

/// How a data set's samples are calibrated from one ensemble (verb bulk).
struct BulkSettings {
    std::string void_ratio = "auto";  // as an input of the emulator: auto | on | off
    std::string paired_by;            // covariate that pairs samples of different groups; empty: none
    int stages = 12;                  // most stages of the shared ensemble
    int confirmation_packings = 3;    // fresh packings for each sample's direct runs
    int posterior_draws = 600;        // in the last round of sampling each posterior
    int mending_rounds = 2;  // of more runs and a new fit for samples whose emulator direct runs show wrong
    bool operator==(const BulkSettings&) const = default;
};

/// How a missing effect is looked for (verb diagnose).
struct DiagnosisSettings {
    std::vector<std::string> candidates;  // effects to consider; empty: every one
    double false_alarm_rate = 0.005;      // of the test whether the model fails anywhere
    int packings = 12;                    // fresh packings for the direct runs of base and leaders
    int fingerprint_packings = 6;         // common packings for each effect's fingerprint
    int leaders = 3;  // effects that get an ensemble of their own, beside those no fingerprint can rule out
    int runs = 48;    // in the first design of each
    bool operator==(const DiagnosisSettings&) const = default;
};

struct Settings {
    std::string verb;
    std::string benchmark;              // of the verb bench
    std::vector<std::string> against;   // other codes to measure beside this engine, of the benchmark engine
    int twins = 0;                      // most, of the benchmarks diagnose and bulk; 0: their own number
    std::filesystem::path sample;       // absolute once resolved
    std::vector<std::string> tests;     // kinds to use; empty: every kind that can be simulated
    std::vector<std::string> hold_out;  // the sample's files to predict, not to fit
    std::filesystem::path packing;      // of the verb simulate; empty: a packing is made
    std::filesystem::path out;          // the run folder, absolute once resolved
    std::uint64_t seed = 1;
    int jobs = 0;  // runs at once; 0: one a core
    bool quiet = false;
    bool json = false;
    std::string law = "linear-cohesive";
    std::string rotation = "blocked";  // blocked | free
    std::vector<std::string> effects;
    int particles = 700;
    int runs = 120;
    std::string method = "emulator";  // of the verb bulk: emulator | inverse-kriging
    std::string confirm = "all";  // of the verb bulk: samples confirmed by direct runs: all | none | a number
    std::string
        inputs_digest;  // of the sample's files and the packing, so that a resumed run meets the same data
    std::map<std::string, double> set;    // parameters held fixed, SI
    std::map<std::string, Prior> priors;  // of every other parameter of the law, once resolved
    EngineSettings engine;
    SpecimenSettings specimen;
    TriaxialSettings triaxial;
    DirectShearSettings direct_shear;
    CalibrationSettings calibration;
    BulkSettings bulk;
    DiagnosisSettings diagnosis;
    bool operator==(const Settings&) const = default;
};

}  // namespace loam::experiments
