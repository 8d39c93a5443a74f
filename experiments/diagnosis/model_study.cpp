#include "experiments/diagnosis/model_study.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "experiments/diagnosis/thresholds.hpp"
#include "experiments/likelihood_terms.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Direct runs of the diagnosis, apart from every round of the calibration.
constexpr std::uint64_t diagnosis_round = 900;
// The estimate is moved, and new direct runs made there, until the next move would change the curves by less
// than this (in their noise), or so often. Of the whole curves a move by one
// noise is nothing, and new packings alone can make it.
constexpr double settled = 1;
constexpr int most_moves = 4;

struct FittedCurve {
    CampaignCurve curve;
    ObservedCurve observed;  // its place among the fitted outputs
};

std::vector<FittedCurve> fitted_curves(const StudiedModel& model) {
    std::vector<FittedCurve> out;
    std::size_t at = 0;
    for (const CampaignCurve& curve : model.campaign.curves())
        if (!curve.test->held_out) out.push_back({curve, model.observation.curves[at++]});
    return out;
}

double floor_of(const FittedCurve& fitted) {
    const std::string_view channel = fitted.curve.channel->name;
    if (channel == "axial_strain") return thresholds::tolerance_strain;
    const lab_data::Test& test = *fitted.curve.test->test;
    if (channel == "deviatoric_stress") return thresholds::tolerance_stress * test.cell_pressure;
    if (channel == "shear_stress") return thresholds::tolerance_stress * test.normal_stress;
    return channel == "settlement" ? thresholds::tolerance_volume * test.box_height
                                   : thresholds::tolerance_volume;
}

/// Adds what sound models differ by: smooth along each curve.
void add_tolerance(const StudiedModel& model, MatrixXd& c) {
    for (const FittedCurve& fitted : fitted_curves(model)) {
        const ObservedCurve& at = fitted.observed;
        const VectorXd x = fitted.curve.test->measured(fitted.curve.test->kind->x_name);
        const VectorXd place = (x / x.cwiseAbs().maxCoeff()).cwiseMax(0.0).cwiseSqrt();
        VectorXd sd(at.count);
        for (Index k = 0; k < at.count; ++k) {
            const double y = model.observation.measured[at.first + k];
            sd[k] = std::hypot(thresholds::tolerance_share * y, floor_of(fitted)) *
                    model.calibration.trained->transforms[static_cast<std::size_t>(at.first + k)].derivative(
                        std::max(y, 0.0));
        }
        for (Index j = 0; j < at.count; ++j)
            for (Index i = 0; i < at.count; ++i)
                c(at.first + i, at.first + j) +=
                    sd[i] * sd[j] * std::exp(-std::abs(place[i] - place[j]) / thresholds::tolerance_length);
    }
}

VectorXd mean_transformed(const StudiedModel& model, const std::vector<RunRecord>& runs) {
    VectorXd sum = VectorXd::Zero(static_cast<Index>(model.calibration.columns.size()));
    double n = 0;
    for (const RunRecord& run : runs) {
        if (!run.ok) continue;
        sum += transformed(model, run.outputs);
        n += 1;
    }
    if (n == 0) throw std::runtime_error("every direct run failed; the first reason: " + runs.at(0).reason);
    return sum / n;
}

/// The model whose curve is the emulator's, moved so that it goes through the runs [.] at x [d].
FittedModel anchored(const StudiedModel& model, const std::vector<RunRecord>& runs, const VectorXd& x) {
    const TrainedEmulator& trained = *model.calibration.trained;
    const double share = model.observation.packing_share;
    const auto averaged = [&trained, share](const VectorXd& at) {
        VectorXd out = 0.5 * (1 - std::min(1.0, share)) * trained.emulator.noise().covariance(at).diagonal();
        for (Index k = 0; k < out.size(); ++k)
            if (trained.transforms[static_cast<std::size_t>(k)].linear) out[k] = 0;
        return out;
    };
    FittedModel out;
    out.measured.resize(model.observation.measured.size());
    for (Index k = 0; k < out.measured.size(); ++k)
        out.measured[k] =
            trained.transforms[static_cast<std::size_t>(k)].forward(model.observation.measured[k]);
    const VectorXd offset = mean_transformed(model, runs) - trained.emulator.predict_mean(x);
    out.curve = [&trained, averaged, offset](const VectorXd& at, MatrixXd* jacobian) {
        return VectorXd(trained.emulator.predict_mean(at, jacobian) + averaged(at) + offset);
    };
    const ParameterSpace& space = model.campaign.space();
    out.prior_mean.resize(space.dimension());
    out.prior_sd.resize(space.dimension());
    for (Index k = 0; k < space.dimension(); ++k) {
        out.prior_mean[k] = space.prior(k).mean_unit();
        out.prior_sd[k] = space.prior(k).sd_unit();
    }
    const auto sound = std::ranges::count_if(runs, [](const RunRecord& run) { return run.ok; });
    out.noise = noise_of_comparison(model, x, static_cast<double>(sound));
    return out;
}

/// By how much a move changes the model's curves, in units of the noise of the comparison.
double size_of_move(const FittedModel& model, const VectorXd& from, const VectorXd& to) {
    const VectorXd change = model.curve(to, nullptr) - model.curve(from, nullptr);
    return std::sqrt(std::max(0.0, change.dot(model.noise.ldlt().solve(change))));
}

/// Moves the estimate to where the model, held to direct runs, is most probable. The direct runs at all but
/// the last place teach the emulator, and with them the posterior is made anew: what is left of the residuals
/// is then the model's fault, not the emulator's.
void settle(StudiedModel& model, std::vector<RunRecord>& runs) {
    Calibration& c = model.calibration;
    const Settings& settings = model.settings();
    model.direct = c.confirmation;
    model.estimate = c.fit.estimate;
    int moves = 0;
    for (; moves < most_moves; ++moves) {
        const FittedModel now = anchored(model, model.direct, model.estimate);
        const VectorXd next = most_probable(now, {}, model.estimate);
        if (moves > 0) {
            if (size_of_move(now, model.estimate, next) < settled) break;
            runs.insert(runs.end(), model.direct.begin(), model.direct.end());
            c.trained.emplace(
                train_emulator(runs, model.campaign.space(), c.columns, c.trained->transforms, settings));
        }
        model.estimate = next;
        model.direct = direct_runs(model.campaign, model.campaign.space().physical(next),
                                   diagnosis_round + static_cast<std::uint64_t>(moves),
                                   settings.diagnosis.packings, "diagnosis: ");
    }
    if (moves > 1) c.fit = fit(*c.trained, model.campaign.space(), model.observation, settings);
}

/// The outputs of the fitted tests in groups of one name.
std::vector<HeldOutGroup> grouped(const StudiedModel& model,
                                  const std::function<std::string(const lab_data::Test&)>& name_of) {
    std::vector<HeldOutGroup> out;
    for (const FittedCurve& fitted : fitted_curves(model)) {
        const std::string name = name_of(*fitted.curve.test->test);
        auto group = std::ranges::find(out, name, &HeldOutGroup::name);
        if (group == out.end()) group = out.insert(out.end(), {name, {}});
        for (Index k = 0; k < fitted.observed.count; ++k) group->outputs.push_back(fitted.observed.first + k);
    }
    return out;
}

}  // namespace

VectorXd transformed(const StudiedModel& model, const VectorXd& outputs) {
    const auto& columns = model.calibration.columns;
    VectorXd out(static_cast<Index>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k)
        out[static_cast<Index>(k)] = model.calibration.trained->transforms[k].forward(outputs[columns[k]]);
    return out;
}

MatrixXd noise_of_comparison(const StudiedModel& model, const VectorXd& x, double direct_runs) {
    const TrainedEmulator& trained = *model.calibration.trained;
    const ReadingNoise readings(model.observation, trained.transforms);
    const MatrixXd packing = trained.emulator.noise().covariance(x);
    MatrixXd out = model.observation.packing_share * readings.of_specimens(packing) + packing / direct_runs;
    readings.add(VectorXd::Zero(static_cast<Index>(readings.misfit_priors().size())), out);
    add_tolerance(model, out);
    return out;
}

std::vector<Region> regions_of(const StudiedModel& model) {
    std::vector<Region> out;
    for (const FittedCurve& fitted : fitted_curves(model)) {
        const CampaignTest& test = *fitted.curve.test;
        RegionCurve curve{test.test->file,
                          std::string(fitted.curve.channel->name),
                          test.test->kind,
                          fitted.observed.first,
                          test.measured(test.kind->x_name),
                          model.simulated.segment(fitted.curve.first, fitted.curve.count()),
                          {}};
        if (!test.test->phase.empty())
            for (const std::size_t reading : test.readings) curve.phase.push_back(test.test->phase[reading]);
        for (Region& region : regions_of(curve)) out.push_back(std::move(region));
    }
    return out;
}

std::vector<HeldOutGroup> tests_to_hold_out(const StudiedModel& model) {
    return grouped(model, [](const lab_data::Test& test) { return test.file; });
}

std::vector<HeldOutGroup> tests_by_kind(const StudiedModel& model) {
    return grouped(model, [](const lab_data::Test& test) { return std::string(to_string(test.kind)); });
}

std::unique_ptr<StudiedModel> study_model(const Settings& settings, const lab_data::Sample& sample,
                                          const std::filesystem::path& folder, RunLog* log,
                                          const std::vector<RunRecord>& known,
                                          const std::optional<Window>& first) {
    std::filesystem::create_directories(folder);
    auto model = std::make_unique<StudiedModel>(settings, sample, folder, log);
    Calibration& c = model->calibration;
    const CalibrationTask task{.chooses = false};  // the estimate is moved below
    std::vector<RunRecord> runs = narrowing_runs(model->campaign, {&task, 1}, first, known);
    runs.insert(runs.end(), known.begin(), known.end());
    c = calibrate(model->campaign, runs, task);
    std::vector<Index> columns;
    model->observation = observation_of(model->campaign, columns);
    settle(*model, runs);
    model->simulated = mean_outputs(model->direct);
    model->fitted = anchored(*model, model->direct, model->estimate);
    model->linear = linearised(model->fitted, model->estimate);
    return model;
}

}  // namespace loam::experiments
