#include "experiments/bulk/group_emulator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "experiments/ensemble/run_seed.hpp"
#include "experiments/likelihood_terms.hpp"
#include "experiments/settings/validation.hpp"
#include "surrogate/designs.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index fewest_readings = 2;
constexpr double within_reach = 3;  // a run informs about samples within this factor of strain
constexpr Index enough_runs = 250;  // below this number none is left out for its distance

/// The runs that reached the stages.
std::vector<const RunRecord*> reaching(const std::vector<RunRecord>& runs, Index stages) {
    std::vector<const RunRecord*> out;
    for (const RunRecord& run : runs)
        if (run.ok && run.outputs[run.outputs.size() - 1] >= static_cast<double>(stages)) out.push_back(&run);
    return out;
}

/// Leaves out runs that are far from every sample's curve at its last stage: they cost time and teach an
/// emulator, whose smoothness is the same everywhere, of regions where nobody looks.
std::vector<const RunRecord*> near(const std::vector<const RunRecord*>& runs,
                                   const std::vector<const BulkSample*>& samples,
                                   const OutputTransform& transform, Index stages) {
    std::vector<const RunRecord*> out;
    for (const RunRecord* run : runs) {
        VectorXd curve(stages);
        for (Index k = 0; k < stages; ++k) curve[k] = transform.forward(run->outputs[k]);
        const bool is_near = std::ranges::any_of(samples, [&](const BulkSample* sample) {
            const Index last = sample->interpolation.rows() - 1;
            const double strain = transform.inverse(sample->interpolation.row(last).dot(curve));
            const double measured = std::max(sample->curve.strain[last], sample->observation.floor);
            return strain <= within_reach * measured && measured <= within_reach * strain;
        });
        if (is_near) out.push_back(run);
    }
    return static_cast<Index>(out.size()) >= enough_runs ? out : runs;
}

surrogate::CurveEmulator train(const SharedEnsemble& ensemble, const std::vector<const RunRecord*>& runs,
                               const OutputTransform& transform, Index stages, const Settings& settings) {
    const auto n = static_cast<Index>(runs.size());
    if (n < fewest_training_runs(static_cast<int>(ensemble.inputs())))
        throw std::runtime_error(
            fmt::format("only {} runs reached {:.4g} kPa, too few to train an emulator; the reasons stand in "
                        "ensemble.h5",
                        n, ensemble.stages().stress[static_cast<std::size_t>(stages - 1)] / 1000));
    MatrixXd inputs(n, ensemble.inputs()), outputs(n, stages);
    for (Index r = 0; r < n; ++r) {
        const RunRecord& run = *runs[static_cast<std::size_t>(r)];
        inputs.row(r) = ensemble.unit(run).transpose();
        for (Index k = 0; k < stages; ++k) outputs(r, k) = transform.forward(run.outputs[k]);
    }
    surrogate::CurveEmulatorOptions options;
    options.kernel = settings.calibration.kernel;
    options.seed = run_seed(settings.seed, 0, 11);
    options.threads = settings.jobs;
    options.starts = 1;
    return surrogate::CurveEmulator::fit(inputs, outputs, options);
}

void make_library(const SharedEnsemble& ensemble, const Settings& settings, Index points,
                  GroupEmulator& group) {
    const Index d = ensemble.space().dimension(), n = ensemble.inputs();
    const MatrixXd u = surrogate::sobol_sequence(points, d + 2, {.seed = run_seed(settings.seed, 0, 31)});
    const MatrixXd x = ensemble.space().from_probabilities(u.leftCols(d));
    group.library.resize(d + 1, points);
    group.library.topRows(d) = x.transpose();
    for (Index k = 0; k < points; ++k) group.library(d, k) = strain_misfit_prior().quantile_unit(u(k, d));
    group.library_void_ratio = u.col(d + 1);
    MatrixXd inputs(points, n);
    inputs.leftCols(d) = x;
    if (n > d) inputs.col(d) = group.library_void_ratio;
    group.emulator.predict_components(inputs, group.library_mean, group.library_variance);
    group.typical_variance = group.emulator.typical_variance();
}

}  // namespace

std::vector<BulkSample> bulk_samples(const SharedEnsemble& ensemble, const lab_data::DataSet& set,
                                     const Settings& settings,
                                     std::vector<std::pair<std::size_t, std::string>>& left_out) {
    std::vector<BulkSample> out;
    const auto all = static_cast<Index>(ensemble.stages().stress.size());
    for (std::size_t row = 0; row < set.rows.size(); ++row) {
        if (!set.rows[row].readable()) continue;
        BulkSample s;
        s.row = row;
        s.test = &std::get<lab_data::Test>(set.rows[row].test);
        s.curve = loading_curve(*s.test);
        if (s.curve.stress.size() < fewest_readings) {
            left_out.emplace_back(
                row, fmt::format("{} loading stages beyond the seating stress, but {} are needed",
                                 s.curve.stress.size(), fewest_readings));
            continue;
        }
        s.observation.measured = s.curve.strain;
        if (const auto sd = s.test->measurement_sd.find("axial_strain"); sd != s.test->measurement_sd.end())
            s.observation.sd = VectorXd::Constant(s.curve.strain.size(), sd->second);
        const int grains = settings.calibration.specimen_particles;
        s.observation.packing_share = grains > 0     ? static_cast<double>(settings.particles) / grains
                                      : set.measured ? 0.0
                                                     : 1.0;
        s.transform = transform_for(s.observation);
        // Few different numbers of stages, so that samples share emulators.
        Index stages = all;
        s.needed = ensemble.stages().needed(s.curve.stress.maxCoeff());
        while (stages - 3 >= s.needed) stages -= 3;
        s.interpolation = ensemble.stages().interpolation(s.curve.stress).leftCols(stages);
        s.void_ratio = ensemble.void_ratio_coordinate(*s.test);
        out.push_back(std::move(s));
    }
    return out;
}

GroupEmulators::GroupEmulators(const SharedEnsemble& ensemble, const std::vector<RunRecord>& runs,
                               const std::vector<BulkSample>& samples, const Settings& settings,
                               Index points) {
    for (const BulkSample& sample : samples) {
        const auto is_of = [](const BulkSample& s, double scale, Index stages) {
            return s.transform.scale == scale && s.stages() == stages;
        };
        if (std::ranges::any_of(
                groups_, [&](const GroupEmulator& g) { return is_of(sample, g.transform.scale, g.stages); }))
            continue;
        std::vector<const BulkSample*> members;
        for (const BulkSample& other : samples)
            if (is_of(other, sample.transform.scale, sample.stages())) members.push_back(&other);
        const auto used = near(reaching(runs, sample.stages()), members, sample.transform, sample.stages());
        groups_.push_back({train(ensemble, used, sample.transform, sample.stages(), settings),
                           sample.transform,
                           sample.stages(),
                           static_cast<Index>(used.size()),
                           {},
                           {},
                           {},
                           {},
                           {}});
        make_library(ensemble, settings, points, groups_.back());
    }
}

std::string GroupEmulator::description() const {
    const surrogate::CurveLeaveOneOut loo = emulator.leave_one_out();
    return fmt::format(
        "emulator of {} stages on the scale ln(1 + strain / {:.3g}): {} runs, {} components, {:.1f} s; its "
        "90 % "
        "intervals hold {:.1f} % of the runs left out",
        stages, transform.scale, runs, emulator.components(), emulator.summary().seconds,
        100 * loo.coverage.mean());
}

const GroupEmulator& GroupEmulators::of(const BulkSample& sample) const {
    const auto found = std::ranges::find_if(groups_, [&](const GroupEmulator& g) {
        return g.transform.scale == sample.transform.scale && g.stages == sample.stages();
    });
    return *found;
}

}  // namespace loam::experiments
