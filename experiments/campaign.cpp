#include "experiments/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "experiments/density.hpp"
#include "experiments/output/progress.hpp"

namespace loam::experiments {
namespace {

/// A run is called quasi-static while the force that is out of balance stays below this share of a contact's
/// force.
constexpr double largest_unbalanced_ratio = 0.15;
constexpr double largest_servo_error = 0.01;

bool wanted(const Settings& settings, const lab_data::Test& test) {
    const std::string kind(to_string(test.kind));
    return settings.tests.empty() || std::ranges::find(settings.tests, kind) != settings.tests.end();
}

lab_data::UserError no_reading(const lab_data::Sample& sample, const lab_data::Test& test) {
    const std::string file = (sample.folder / test.file).string();
    if (test.kind == lab_data::TestKind::oedometer)
        return lab_data::UserError({.file = file,
                                    .constraint = "has no reading beyond the seating stress",
                                    .remedy = "give further stages, or a lower seating_stress_kPa"});
    if (test.kind == lab_data::TestKind::direct_shear)
        return lab_data::UserError(
            {.file = file,
             .constraint = "has no reading at a displacement between 0 and 0.4 of the box's length",
             .remedy = "give readings with rising shear_displacement"});
    return lab_data::UserError({.file = file,
                                .constraint = "has no reading at an axial strain between 0 and 0.5",
                                .remedy = "give readings with rising axial_strain, compression positive"});
}

/// One parameter set is to describe specimens of all densities: where they are far apart, what the model
/// leaves out of density's part shows as a disagreement of the tests.
void warn_of_densities(const std::vector<const lab_data::Test*>& tests, std::vector<std::string>& warnings) {
    constexpr double far_apart = 0.2;
    const auto of = [](const lab_data::Test& test) { return test.initial_void_ratio.value_or(NAN); };
    const lab_data::Test *loosest = nullptr, *densest = nullptr;
    for (const lab_data::Test* test : tests) {
        if (std::isnan(of(*test))) continue;
        if (loosest == nullptr || of(*test) > of(*loosest)) loosest = test;
        if (densest == nullptr || of(*test) < of(*densest)) densest = test;
    }
    if (loosest == nullptr || of(*loosest) - of(*densest) <= far_apart) return;
    warnings.push_back(
        fmt::format("initial void ratios span {:.3f} ({}) to {:.3f} ({}): one parameter set has to "
                    "describe both",
                    of(*densest), densest->file, of(*loosest), loosest->file));
}

/// Boxes are made in the measured proportions. With a side that is wrong, as by its unit, they take far more
/// particles, and time, than was asked for.
void warn_of_particles(const Settings& settings, const lab_data::Test& test, const SpecimenShape& shape,
                       std::vector<std::string>& warnings) {
    constexpr double far_more = 10;
    if (shape.particles <= far_more * settings.particles) return;
    warnings.push_back(
        fmt::format("{}: the proportions of its box (box_length_mm, box_width_mm, box_height_mm) make a "
                    "specimen of {} particles, where {} are asked for",
                    test.file, shape.particles, settings.particles));
}

/// Packing files hold periodic cells: what lies in a box cannot be loaded from them.
bool can_take_the_packing(const Settings& settings, const lab_data::Sample& sample,
                          const lab_data::Test& test, const LabTestKind& kind) {
    return settings.packing.empty() || !kind.shape(settings, sample, test, 0.4, 700).proportions;
}

std::vector<CampaignTest> select_tests(const Settings& settings, const lab_data::Sample& sample,
                                       std::vector<std::string>& warnings) {
    std::vector<CampaignTest> out;
    Eigen::Index first = 0;
    for (const lab_data::Test& test : sample.tests) {
        if (!wanted(settings, test)) continue;
        const LabTestKind* kind = &lab_test(test.kind);
        if (!can_take_the_packing(settings, sample, test, *kind)) {
            if (!settings.tests.empty())
                throw lab_data::UserError({.column = "--packing",
                                           .value = settings.packing.string(),
                                           .constraint = "is a periodic cell, but the specimen of " +
                                                         test.file + " lies between walls",
                                           .remedy = "leave --packing out, or use --tests oedometer"});
            warnings.push_back(fmt::format(
                "{} is left out: its specimen lies between walls, the packing given does not", test.file));
            continue;
        }
        CampaignTest entry{&test, kind,  kind->readings(test),
                           first, false, target_porosity(settings, sample, test)};
        if (entry.readings.empty()) throw no_reading(sample, test);
        warn_of_particles(settings, test,
                          kind->shape(settings, sample, test, entry.porosity,
                                      static_cast<std::uint32_t>(settings.particles)),
                          warnings);
        if (entry.readings.size() < test.size() / 2)
            warnings.push_back(fmt::format("{}: {} of {} readings are used, spread along the curve",
                                           test.file, entry.readings.size(), test.size()));
        entry.held_out = std::ranges::find(settings.hold_out, test.file) != settings.hold_out.end();
        first += entry.outputs();
        out.push_back(entry);
    }
    std::vector<const lab_data::Test*> selected;
    for (const CampaignTest& test : out) selected.push_back(test.test);
    warn_of_densities(selected, warnings);
    if (out.empty())
        throw lab_data::UserError({.file = sample.folder.string(),
                                   .constraint = "has no test of the kinds asked for",
                                   .remedy = "leave --tests out, or name kinds that the sample has"});
    return out;
}

/// What two options add to the header.
void add_options(const CampaignOptions& options, EnsembleHeader& header) {
    if (options.void_ratio)
        header.parameters.push_back(
            {"initial_void_ratio", "", options.void_ratio->first, options.void_ratio->second});
    if (options.keep_partial) header.outputs.push_back({"", "stages_reached", "", "", "", 0});
}

EnsembleHeader make_header(const Settings& settings, const ParameterSpace& space,
                           const std::vector<CampaignTest>& tests, double grain_density,
                           const CampaignOptions& options) {
    EnsembleHeader header;
    header.campaign_seed = settings.seed;
    for (std::size_t p = 0; p < space.parameters.size(); ++p) {
        const engine::ParameterInfo& info = space.parameters[p];
        const double value = space.values[static_cast<Eigen::Index>(p)];
        header.parameters.push_back({std::string(info.name), std::string(info.unit), value, value});
    }
    for (std::size_t k = 0; k < space.fitted.size(); ++k) {
        header.parameters[space.fitted[k]].lower = space.priors[k].lower;
        header.parameters[space.fitted[k]].upper = space.priors[k].upper;
    }
    for (const CampaignTest& test : tests)
        for (const OutputColumn& column : output_columns(*test.kind, *test.test))
            header.outputs.push_back(column);
    add_options(options, header);
    header.diagnostics = {{"inertial_number", ""}, {"unbalanced_ratio", ""}, {"servo_error", ""},
                          {"overlap", ""},         {"energy_error", ""},     {"steps", ""},
                          {"porosity", ""}};
    auto& a = header.attributes;
    a["program_version"] = LOAM_VERSION;
    a["law"] = settings.law;
    a["rotation"] = settings.rotation;
    a["inputs_digest"] = settings.inputs_digest;
    a["grain_density_kg_m3"] = fmt::format("{}", grain_density);
    a["size_spread"] = fmt::format("{}", settings.specimen.size_spread);
    a["preparation_stress_kPa"] = fmt::format("{}", settings.specimen.preparation_stress_kPa);
    a["damping"] = fmt::format("{}", settings.engine.damping);
    a["density_scaling"] = settings.engine.density_scaling ? "true" : "false";
    a["time_step_safety"] = fmt::format("{}", settings.engine.time_step_safety);
    a["inertial_number"] = fmt::format("{}", settings.engine.inertial_number);
    a["haste"] = fmt::format("{}", settings.engine.haste);
    a["fragile"] = settings.engine.fragile ? "true" : "false";
    a["interaction_range"] = fmt::format("{}", settings.engine.interaction_range);
    a["triaxial_boundary"] = settings.triaxial.boundary;
    a["box_diameters"] = settings.direct_shear.box_diameters
                             ? fmt::format("{}", *settings.direct_shear.box_diameters)
                             : "as measured";
    a["gap_diameters"] = fmt::format("{}", settings.direct_shear.gap_diameters);
    for (const CampaignTest& test : tests)
        a["specimen_porosity " + test.test->file] = fmt::format("{}", test.porosity);
    return header;
}

/// The packing of the settings' file, if they name one.
std::shared_ptr<const Specimen> given_specimen(const Settings& settings) {
    if (settings.packing.empty()) return nullptr;
    engine::Packing packing = load_packing(settings.packing);
    const double porosity = packing.porosity();
    return std::make_shared<const Specimen>(Specimen{std::move(packing), std::nullopt, porosity});
}

/// Makes a result of the stages that a run reached, if it was sound up to there; returns their number.
double keep_reached(VirtualTestResult& result) {
    Eigen::Index reached = 0;
    while (reached < result.outputs.size() && std::isfinite(result.outputs[reached])) ++reached;
    if (!result.stopped_early || reached == 0) return static_cast<double>(reached);
    result.outputs.tail(result.outputs.size() - reached).setConstant(result.outputs[reached - 1]);
    result.ok =
        result.unbalanced_ratio <= largest_unbalanced_ratio && result.servo_error <= largest_servo_error;
    return static_cast<double>(reached);
}

}  // namespace

std::vector<std::string> check_tests(const Settings& settings, const lab_data::Sample& sample) {
    constexpr double any_porosity = 0.4;
    std::vector<std::string> warnings;
    std::vector<const lab_data::Test*> selected;
    for (const lab_data::Test& test : sample.tests) {
        if (!wanted(settings, test)) continue;
        const LabTestKind& kind = lab_test(test.kind);
        if (kind.readings(test).empty()) throw no_reading(sample, test);
        warn_of_particles(
            settings, test,
            kind.shape(settings, sample, test, any_porosity, static_cast<std::uint32_t>(settings.particles)),
            warnings);
        target_porosity(settings, sample, test);
        selected.push_back(&test);
    }
    warn_of_densities(selected, warnings);
    return warnings;
}

Eigen::VectorXd CampaignTest::measured(std::string_view column) const {
    const std::vector<double>& all = test->column(std::string(column));
    Eigen::VectorXd out(static_cast<Eigen::Index>(readings.size()));
    for (Eigen::Index k = 0; k < out.size(); ++k) out[k] = all[readings[static_cast<std::size_t>(k)]];
    return out;
}

Campaign::Campaign(const Settings& settings, const lab_data::Sample& sample,
                   const std::filesystem::path& folder, RunLog* log, const CampaignOptions& options)
    : settings_(settings),
      sample_(&sample),
      options_(options),
      space_(parameter_space(settings)),
      effects_(settings),
      tests_(select_tests(settings, sample, warnings_)),
      grain_density_(settings.specimen.grain_density_kg_m3.value_or(
          sample.grain_density > 0 ? sample.grain_density : 2600.0)),
      measured_(sample.measured),
      given_(given_specimen(settings)),  // before the store, so that a faulty file leaves none
      store_(folder, make_header(settings, space_, tests_, grain_density_, options)),
      log_(log) {
    for (const CampaignTest& test : tests_) outputs_ += test.outputs();
    // The kinds are in the order of their cost. What fails are mostly triaxial tests of stiff particles,
    // which cost a third of direct shear tests.
    as_simulated_.resize(tests_.size());
    std::iota(as_simulated_.begin(), as_simulated_.end(), 0);
    std::ranges::stable_sort(as_simulated_, {}, [&](std::size_t k) { return tests_[k].test->kind; });
}

std::vector<CampaignCurve> Campaign::curves() const {
    std::vector<CampaignCurve> out;
    for (const CampaignTest& test : tests_)
        for (std::size_t c = 0; c < test.kind->channels.size(); ++c)
            out.push_back({&test, &test.kind->channels[c], test.first_of(c)});
    return out;
}

double Campaign::porosity_of(const CampaignTest& test, const RunSpec& spec) const {
    const double error = effects_.void_ratio_error(spec.parameters);
    if (!options_.void_ratio && error == 0) return test.porosity;
    const double stated = options_.void_ratio ? spec.parameters[spec.parameters.size() - 1]
                                              : test.porosity / (1 - test.porosity);
    const double void_ratio = std::max(0.0, stated + error);
    return void_ratio / (1 + void_ratio);
}

std::shared_ptr<const Specimen> Campaign::specimen_of(const CampaignTest& test, const RunSpec& spec,
                                                      const StopToken& stop) {
    if (given_) return given_;
    const double porosity = porosity_of(test, spec);
    const SpecimenShape shape = test.kind->shape(settings_, *sample_, *test.test, porosity, spec.particles);
    return specimen_pool().get(settings_.specimen, porosity, shape, spec.packing_seed, stop);
}

std::shared_ptr<const Specimen> Campaign::specimen(const CampaignTest& test, const RunSpec& spec) {
    return specimen_of(test, spec, SignalScope::token());
}

RunRecord Campaign::simulate(const RunSpec& spec, const StopToken& stop) {
    RunRecord record;
    record.outputs.resize(outputs_ + (options_.keep_partial ? 1 : 0));
    record.diagnostics = Eigen::VectorXd::Zero(diagnostic_count);
    record.ok = true;
    for (const std::size_t which : as_simulated_) {
        const CampaignTest& test = tests_[which];
        const auto specimen = specimen_of(test, spec, stop);
        const engine::ContactLaw law = contact_law(settings_, spec.parameters);
        const SimulatedTest simulated{*test.kind, *test.test, test.readings};
        const auto run_on = [&](const lab_data::Test& met) {
            return test.kind->run(*specimen, law, settings_, grain_density_, met, [&] {
                stop.throw_if_requested();
                return false;
            });
        };
        VirtualTestResult result =
            effects_.empty() ? run_on(*test.test) : run_on(effects_.as_met(simulated, spec.parameters));
        effects_.correct(simulated, spec.parameters, result.outputs);
        auto& d = record.diagnostics;
        const auto worst = [&](Diagnostic which, double value) { d[which] = std::max(d[which], value); };
        worst(inertial_number, result.inertial_number);
        worst(unbalanced_ratio, result.unbalanced_ratio);
        worst(servo_error, result.servo_error);
        worst(overlap, result.overlap);
        worst(energy_error, result.energy_error);
        worst(porosity, specimen->porosity);
        d[steps] += result.steps;
        if (result.ok && result.unbalanced_ratio > largest_unbalanced_ratio) {
            result.ok = false;
            result.reason =
                fmt::format("not quasi-static: mean unbalanced-force ratio {:.3f}", result.unbalanced_ratio);
        }
        if (result.ok && result.servo_error > largest_servo_error) {
            result.ok = false;
            result.reason =
                fmt::format("the stress that is held was missed by {:.1f} %", 100 * result.servo_error);
        }
        if (options_.keep_partial) record.outputs[outputs_] = keep_reached(result);
        if (!result.ok) {
            record.ok = false;
            record.reason = fmt::format("{}: {}", test.test->file, result.reason);
            record.outputs.resize(0);
            return record;
        }
        record.outputs.segment(test.first, result.outputs.size()) = result.outputs;
    }
    return record;
}

std::vector<RunRecord> Campaign::run(std::string_view title, std::span<const RunSpec> specs) {
    ProgressOptions shown;
    shown.style = progress_style(settings_.quiet);
    Progress progress(std::string(title), specs.size(), shown);
    EnsembleOptions options;
    options.jobs = settings_.jobs;
    options.on_progress = [&](const EnsembleProgress& now) {
        progress.update({now.reused + now.executed, now.reused, now.failed});
    };
    EnsembleSummary summary = run_ensemble(
        store_, specs, [this](const RunSpec& s, const StopToken& stop) { return simulate(s, stop); },
        options);
    progress.finish();
    if (log_ != nullptr)
        log_->write(fmt::format("{}: {} runs, {} of them made before, {} failed, {:.1f} s", title,
                                specs.size(), summary.reused, summary.failed, summary.seconds));
    return std::move(summary.records);
}

std::size_t failed_count(const EnsembleStore& store) {
    const std::vector<RunRecord> all = store.records();
    return static_cast<std::size_t>(std::ranges::count_if(all, [](const RunRecord& r) { return !r.ok; }));
}

}  // namespace loam::experiments
