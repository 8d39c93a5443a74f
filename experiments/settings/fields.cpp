#include "experiments/settings/fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "experiments/effects/model_effects.hpp"
#include "experiments/workflows/benchmarks/other_codes.hpp"
#include "lab_data/sample.hpp"
#include "optimizers/registry.hpp"
#include "surrogate/kernels/registry.hpp"

namespace loam::experiments {
namespace {

using Names = std::vector<std::string_view>;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr auto largest_integer = static_cast<double>(std::numeric_limits<std::int64_t>::max());
constexpr Limits above_zero{.lower = 0, .open_lower = true};
constexpr Limits packable{.lower = 0.05, .upper = 0.6, .open_lower = true, .open_upper = true};
constexpr Limits up_to_one{.lower = 0, .upper = 1, .open_lower = true};

constexpr Limits count(double least, double most = 1e6) {
    return {.lower = least, .upper = most};
}

Names verbs_with_settings() {
    return {"simulate", "calibrate", "bulk", "crosstest", "diagnose", "bench"};
}
Names bench() {
    return {"bench"};
}
Names bulk_and_bench() {
    return {"bulk", "bench"};
}
Names rotations() {
    return {"blocked", "free"};
}
Names code_names() {
    Names names;
    for (const OtherCode& code : other_codes()) names.push_back(code.name);
    return names;
}
Names methods() {
    return {"emulator", "inverse-kriging"};
}
Names matches() {
    return {"void_ratio", "relative_density"};
}
Names boundaries() {
    return {"periodic", "walls"};
}
Names three_ways() {
    return {"auto", "on", "off"};
}
Names designs() {
    return {"latin-hypercube", "sobol"};
}
Names kernels() {
    Names names;
    for (const surrogate::KernelInfo& kernel : surrogate::kernels()) names.push_back(kernel.name);
    return names;
}

Names global_optimisers() {
    Names names;
    for (const optimizers::Optimiser& entry : optimizers::optimisers())
        if (entry.scope == optimizers::Scope::global) names.push_back(entry.name);
    return names;
}

Names law_names() {
    Names names;
    for (const engine::LawInfo& law : engine::laws()) names.push_back(law.name);
    return names;
}

Names effect_names() {
    Names names;
    for (const ModelEffect& effect : model_effects()) names.push_back(effect.name);
    return names;
}

Names test_kinds() {
    using lab_data::TestKind;
    return {to_string(TestKind::oedometer), to_string(TestKind::triaxial), to_string(TestKind::direct_shear)};
}

// clang-format off
const std::array table{
    Field{"", "verb", [](Settings& s) -> Slot { return &s.verb; },
          "what was asked for", {}, verbs_with_settings},
    Field{"", "benchmark", [](Settings& s) -> Slot { return &s.benchmark; },
          "which benchmark, of the verb bench"},
    Field{"", "against", [](Settings& s) -> Slot { return &s.against; },
          "other codes, where installed, that `loam bench engine` measures beside this engine", {}, code_names, "CODE,...",
          Resuming::may_differ, bench},
    Field{"", "twins", [](Settings& s) -> Slot { return &s.twins; },
          "most twins of `loam bench diagnose`, or samples of `loam bench bulk`; 0: the benchmark's own number", count(0), nullptr, "N", Resuming::may_differ, bench},
    Field{"", "sample", [](Settings& s) -> Slot { return &s.sample; },
          "folder of the sample", {}, nullptr, "", Resuming::may_differ},
    Field{"", "tests", [](Settings& s) -> Slot { return &s.tests; },
          "kinds of test to use, separated by commas (default: every kind that can be simulated)", {}, test_kinds, "KIND,..."},
    Field{"", "hold_out", [](Settings& s) -> Slot { return &s.hold_out; },
          "tests of the sample, by file, to predict but not to fit", {}, nullptr, "FILE,..."},
    Field{"", "packing", [](Settings& s) -> Slot { return &s.packing; },
          "specimen to load: CSV with x_m,y_m,z_m,radius_m (default: one is made)", {}, nullptr, "FILE.csv",
          Resuming::may_differ},
    Field{"", "out", [](Settings& s) -> Slot { return &s.out; },
          "folder of the run (default: runs/VERB-NAME)", {}, nullptr, "DIR", Resuming::may_differ},
    Field{"", "seed", [](Settings& s) -> Slot { return &s.seed; },
          "of all random numbers", {.lower = 0, .upper = largest_integer}, nullptr, "N"},
    Field{"", "jobs", [](Settings& s) -> Slot { return &s.jobs; },
          "simulations at once; 0: one a core", count(0, 4096), nullptr, "N", Resuming::may_differ},
    Field{"", "quiet", [](Settings& s) -> Slot { return &s.quiet; },
          "no progress on standard error", {}, nullptr, "flag", Resuming::may_differ},
    Field{"", "json", [](Settings& s) -> Slot { return &s.json; },
          "the result on standard output as JSON", {}, nullptr, "flag", Resuming::may_differ},
    Field{"", "law", [](Settings& s) -> Slot { return &s.law; },
          "contact law (see `loam effects`)", {}, law_names, "NAME"},
    Field{"", "rotation", [](Settings& s) -> Slot { return &s.rotation; },
          "rotation of the particles", {}, rotations, "free|blocked"},
    Field{"", "effects", [](Settings& s) -> Slot { return &s.effects; },
          "effects added to the law or the test (see `loam effects`)", {}, effect_names, "NAME,..."},
    Field{"", "particles", [](Settings& s) -> Slot { return &s.particles; },
          "particles in a specimen", count(100, 2e6), nullptr, "N"},
    Field{"", "runs", [](Settings& s) -> Slot { return &s.runs; },
          "simulations in the first design (calibrate, crosstest: 20, and 20 for each fitted parameter; diagnose likewise, at most 80; bulk: 959)", count(1), nullptr, "N"},
    Field{"", "method", [](Settings& s) -> Slot { return &s.method; },
          "of the verb bulk: how parameters are found", {}, methods, "emulator|inverse-kriging", Resuming::must_agree, bulk_and_bench},
    Field{"", "confirm", [](Settings& s) -> Slot { return &s.confirm; },
          "of the verb bulk: samples whose estimate is confirmed by direct runs", {}, nullptr, "all|N|none", Resuming::may_differ, bulk_and_bench},
    Field{"", "inputs_digest", [](Settings& s) -> Slot { return &s.inputs_digest; },
          "of the sample's files and the packing; worked out anew for each run"},

    Field{"engine", "damping", [](Settings& s) -> Slot { return &s.engine.damping; },
          "Cundall's local damping, 1", {.lower = 0, .upper = 1, .open_upper = true}},
    Field{"engine", "density_scaling", [](Settings& s) -> Slot { return &s.engine.density_scaling; },
          "small particles are as heavy, and spins as slow, as the mean one's time step demands"},
    Field{"engine", "time_step_safety", [](Settings& s) -> Slot { return &s.engine.time_step_safety; },
          "time step over the longest that is stable, 1", up_to_one},
    Field{"engine", "inertial_number", [](Settings& s) -> Slot { return &s.engine.inertial_number; },
          "target while loading, 1: sets the strain rate", {.lower = 0, .upper = 0.1, .open_lower = true}},
    Field{"engine", "haste", [](Settings& s) -> Slot { return &s.engine.haste; },
          "rates of loading over the careful ones, 1 (default for bulk and diagnose: 3)", {.lower = 0.1, .upper = 10}},
    Field{"engine", "fragile", [](Settings& s) -> Slot { return &s.engine.fragile; },
          "a cohesive bond, once broken, does not heal"},
    Field{"engine", "interaction_range", [](Settings& s) -> Slot { return &s.engine.interaction_range; },
          "reach of a cohesive bond over the sum of radii, 1", {.lower = 1, .upper = 2}},

    Field{"specimen", "size_spread", [](Settings& s) -> Slot { return &s.specimen.size_spread; },
          "radii are uniform over the mean radius times 1 +- this, 1 (default: as the sample's grading has it if its largest grains are at most three times its smallest)", {.lower = 0, .upper = 0.9}},
    Field{"specimen", "porosity", [](Settings& s) -> Slot { return &s.specimen.porosity; },
          "of the specimen, 1 (default: from the test's initial void ratio)", packable},
    Field{"specimen", "match", [](Settings& s) -> Slot { return &s.specimen.match; },
          "what a specimen has in common with the measured one: its void ratio, or its relative density", {}, matches},
    Field{"specimen", "grain_density_kg_m3", [](Settings& s) -> Slot { return &s.specimen.grain_density_kg_m3; },
          "of the grains, kg/m3 (default: the sample's)", {.lower = 100, .upper = 30000}},
    Field{"specimen", "preparation_stress_kPa", [](Settings& s) -> Slot { return &s.specimen.preparation_stress_kPa; },
          "under which a specimen is made, kPa", above_zero},

    Field{"triaxial", "boundary", [](Settings& s) -> Slot { return &s.triaxial.boundary; },
          "of the specimen: a periodic cell, or a cube of rigid walls", {}, boundaries},
    Field{"direct_shear", "box_diameters", [](Settings& s) -> Slot { return &s.direct_shear.box_diameters; },
          "length of the box over the mean diameter, 1 (default: as measured, where the grading tells and it is at most 20)", {.lower = 10, .upper = 200}},
    Field{"direct_shear", "gap_diameters", [](Settings& s) -> Slot { return &s.direct_shear.gap_diameters; },
          "between the halves of the box over the mean diameter, 1", {.lower = 0, .upper = 1, .open_upper = true}},

    Field{"calibration", "design", [](Settings& s) -> Slot { return &s.calibration.design; },
          "of the first runs", {}, designs},
    Field{"calibration", "narrowing", [](Settings& s) -> Slot { return &s.calibration.narrowing; },
          "a third of the first runs lie over the whole prior, the rest where that leaves the parameters plausible", {}},
    Field{"calibration", "kernel", [](Settings& s) -> Slot { return &s.calibration.kernel; },
          "covariance of the emulator", {}, kernels},
    Field{"calibration", "global_optimizer", [](Settings& s) -> Slot { return &s.calibration.global_optimizer; },
          "of the search on the emulator", {}, global_optimisers},
    Field{"calibration", "replicates", [](Settings& s) -> Slot { return &s.calibration.replicates; },
          "further packings, from which packing noise is learnt", count(0)},
    Field{"calibration", "confirmation_packings", [](Settings& s) -> Slot { return &s.calibration.confirmation_packings; },
          "fresh packings for the direct runs at the estimate", count(1)},
    Field{"calibration", "max_rounds", [](Settings& s) -> Slot { return &s.calibration.max_rounds; },
          "rounds of runs added where emulator and direct runs disagree", count(0, 19)},
    Field{"calibration", "runs_per_round", [](Settings& s) -> Slot { return &s.calibration.runs_per_round; },
          "runs in each of them", count(1)},
    Field{"calibration", "posterior_draws", [](Settings& s) -> Slot { return &s.calibration.posterior_draws; },
          "kept draws of the posterior", count(100, 1e7)},
    Field{"calibration", "specimen_particles", [](Settings& s) -> Slot { return &s.calibration.specimen_particles; },
          "particles in the measured specimen, whose scatter they set; 0: countless if measured, as the runs if synthetic", count(0, std::numeric_limits<int>::max())},
    Field{"bulk", "void_ratio", [](Settings& s) -> Slot { return &s.bulk.void_ratio; },
          "initial void ratio of each sample as an input of the emulator; auto: where packings can reach it", {}, three_ways},
    Field{"bulk", "paired_by", [](Settings& s) -> Slot { return &s.bulk.paired_by; },
          "covariate whose equal values pair samples of different groups, for signed-rank tests", {}, nullptr, "", Resuming::may_differ},
    Field{"bulk", "stages", [](Settings& s) -> Slot { return &s.bulk.stages; },
          "most stages of the shared ensemble; samples' own are interpolated if there are more", count(4, 40)},
    Field{"bulk", "confirmation_packings", [](Settings& s) -> Slot { return &s.bulk.confirmation_packings; },
          "fresh packings for each sample's direct runs at the estimate", count(1)},
    Field{"bulk", "posterior_draws", [](Settings& s) -> Slot { return &s.bulk.posterior_draws; },
          "draws in the last round of each sample's posterior", count(100, 1e6)},
    Field{"bulk", "mending_rounds", [](Settings& s) -> Slot { return &s.bulk.mending_rounds; },
          "rounds of further runs for samples whose emulator direct runs show to be wrong", count(0, 9)},
    Field{"diagnosis", "candidates", [](Settings& s) -> Slot { return &s.diagnosis.candidates; },
          "effects to consider (default: every one that the model has not)", {}, effect_names},
    Field{"diagnosis", "false_alarm_rate", [](Settings& s) -> Slot { return &s.diagnosis.false_alarm_rate; },
          "of the test whether the model fails anywhere, for the whole sample, 1", {.lower = 5e-4, .upper = 0.2}},
    Field{"diagnosis", "packings", [](Settings& s) -> Slot { return &s.diagnosis.packings; },
          "fresh packings for the direct runs of the base model and the leading effects", count(2)},
    Field{"diagnosis", "fingerprint_packings", [](Settings& s) -> Slot { return &s.diagnosis.fingerprint_packings; },
          "packings, common with the base model, for each effect's fingerprint", count(2)},
    Field{"diagnosis", "leaders", [](Settings& s) -> Slot { return &s.diagnosis.leaders; },
          "leading effects that get an ensemble of their own", count(1, 20)},
    Field{"diagnosis", "runs", [](Settings& s) -> Slot { return &s.diagnosis.runs; },
          "simulations in the first design of each", count(1)},
};
// clang-format on

}  // namespace

bool Limits::contain(double value) const {
    const bool above = open_lower ? value > lower : value >= lower;
    const bool below = open_upper ? value < upper : value <= upper;
    return above && below && std::isfinite(value);
}

std::string Limits::text() const {
    // No double is the largest integer itself.
    const std::string most = upper == largest_integer
                                 ? fmt::format("{}", std::numeric_limits<std::int64_t>::max())
                                 : fmt::format("{}", upper);
    std::string text = "must be ";
    if (lower > -infinity) text += fmt::format("{} {}", open_lower ? "above" : "at least", lower);
    if (lower > -infinity && upper < infinity) text += " and ";
    if (upper < infinity) text += fmt::format("{} {}", open_upper ? "below" : "at most", most);
    if (lower == -infinity && upper == infinity) text += "a finite number";
    return text;
}

bool Field::is_option_of(std::string_view verb) const {
    return !option.empty() && (!verbs || std::ranges::count(verbs(), verb) > 0);
}

std::string Field::path() const {
    return section.empty() ? std::string(key) : fmt::format("{}.{}", section, key);
}

std::span<const Field> fields() {
    return table;
}

const Field* find_field(std::string_view section, std::string_view key) {
    const auto found =
        std::ranges::find_if(table, [&](const Field& f) { return f.section == section && f.key == key; });
    return found == table.end() ? nullptr : &*found;
}

std::vector<std::string_view> sections() {
    std::vector<std::string_view> names;
    for (const Field& field : table)
        if (!field.section.empty() && (names.empty() || names.back() != field.section))
            names.push_back(field.section);
    return names;
}

}  // namespace loam::experiments
