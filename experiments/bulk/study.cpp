#include "experiments/bulk/study.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <functional>
#include <stdexcept>

#include "experiments/bulk/fit_journal.hpp"
#include "experiments/bulk/inverse_kriging.hpp"
#include "experiments/bulk/verdict.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/output/progress.hpp"
#include "experiments/settings/validation.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::uint64_t fit_stream = 32, design_stream = 33;
constexpr double first_share = 0.4;  // of the training runs that are spread over the prior

/// Adds the seconds of a stretch of work to the study's parts.
class PartTimer {
  public:
    PartTimer(BulkStudy& study, std::string name)
        : study_(study), name_(std::move(name)), began_(std::chrono::steady_clock::now()) {}
    ~PartTimer() {
        study_.parts.push_back(
            {name_, std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count()});
    }
    PartTimer(const PartTimer&) = delete;
    PartTimer& operator=(const PartTimer&) = delete;

  private:
    BulkStudy& study_;
    std::string name_;
    std::chrono::steady_clock::time_point began_;
};

/// Further runs where the samples' posteriors lie by the emulators of the first runs: the prior is much wider
/// than any data set, and an emulator must be good where it is asked.
std::vector<RunRecord> further_runs(SharedEnsemble& ensemble, const Settings& settings,
                                    const std::vector<RunRecord>& first,
                                    const std::vector<BulkSample>& samples, Index count, BulkStudy& study) {
    if (auto stored = ensemble.stored_further(count)) return std::move(*stored);
    Eigen::MatrixXd points(count, ensemble.space().dimension());
    {
        const PartTimer timer(study, "design of further runs");
        const GroupEmulators emulators(ensemble, first, samples, settings);
        const auto n = static_cast<Index>(samples.size());
        const Index each = (count + n - 1) / n;
#pragma omp parallel for schedule(dynamic) \
    num_threads(settings.jobs > 0 ? settings.jobs : omp_get_max_threads())
        for (Index k = 0; k < std::min(n, count); ++k) {
            // With more samples than runs, every so many samples has one.
            const BulkSample& sample = samples[static_cast<std::size_t>(k * n / std::min(n, count))];
            const Eigen::MatrixXd mine = likely_points(sample, emulators.of(sample), ensemble.space(), each,
                                                       run_seed(settings.seed, sample.row, design_stream));
            for (Index j = 0; j < each; ++j)
                if (const Index at = j * std::min(n, count) + k; at < count) points.row(at) = mine.row(j);
        }
    }
    const PartTimer timer(study, "further training runs");
    return ensemble.train_at(points);
}

FittedSample kept(const SampleFit& fit, std::size_t row) {
    FittedSample out;
    out.row = row;
    out.estimate = fit.estimate;
    out.quantiles = fit.quantiles;
    out.misfit = fit.misfit;
    out.effective = fit.effective;
    out.emulator_share = fit.emulator_share;
    out.predicted = fit.predicted;
    return out;
}

/// Fits the samples that the journal does not hold, on all cores; what fails leaves its reason.
class Fitting {
  public:
    Fitting(const Settings& settings, FitJournal& journal, BulkStudy& study)
        : settings_(settings), journal_(journal), study_(study) {}

    /// `method` gives the fit of a sample; throws std::runtime_error with the reason where there is none.
    void run(const std::function<FittedSample(const BulkSample&)>& method,
             const std::vector<const BulkSample*>& todo, std::size_t before) {
        ProgressOptions shown;
        shown.style = progress_style(settings_.quiet);
        Progress progress("fits", todo.size() + before, shown);
        const StopToken stop = SignalScope::token();
        std::atomic<std::size_t> done{0};
        const int threads = settings_.jobs > 0 ? settings_.jobs : omp_get_max_threads();
        std::exception_ptr broken;  // the journal cannot be written
#pragma omp parallel for schedule(dynamic) num_threads(threads)
        for (std::size_t k = 0; k < todo.size(); ++k) {
            if (stop.stop_requested()) continue;
            try {
                fit(method, *todo[k]);
            } catch (...) {
#pragma omp critical
                broken = std::current_exception();
            }
            ++done;
            if (omp_get_thread_num() == 0) progress.update({before + done, before, 0});
        }
        progress.finish();
        if (broken) std::rethrow_exception(broken);
        stop.throw_if_requested();
    }

  private:
    void fit(const std::function<FittedSample(const BulkSample&)>& method, const BulkSample& sample) {
        SampleOutcome& outcome = study_.samples[sample.row];
        try {
            outcome.fit = method(sample);
        } catch (const std::runtime_error& error) {
            outcome.status = "failed";
            outcome.reason = error.what();
            return;
        }
        journal_.append(*outcome.fit);
    }

    const Settings& settings_;
    FitJournal& journal_;
    BulkStudy& study_;
};

void fit_all(SharedEnsemble& ensemble, const Settings& settings, const std::vector<BulkSample>& samples,
             const std::filesystem::path& folder, BulkStudy& study) {
    FitJournal journal(folder / "fits.jsonl");
    std::vector<const BulkSample*> todo;
    for (const BulkSample& sample : samples) {
        const auto at = journal.found().find(sample.row);
        if (at == journal.found().end())
            todo.push_back(&sample);
        else
            study.samples[sample.row].fit = at->second;
    }
    if (todo.empty()) return;
    Fitting fitting(settings, journal, study);
    const std::size_t before = samples.size() - todo.size();
    if (settings.method == "inverse-kriging") {
        const PartTimer timer(study, "fits");
        InverseKriging kriging(ensemble, study.training);
        fitting.run([&](const BulkSample& sample) { return kriging.fit(sample); }, todo, before);
        return;
    }
    std::optional<GroupEmulators> emulators;
    {
        const PartTimer timer(study, "emulators");
        emulators.emplace(ensemble, study.training, samples, settings);
    }
    for (const GroupEmulator& g : emulators->all()) study.emulators.push_back(g.description());
    const PartTimer timer(study, "fits");
    fitting.run(
        [&](const BulkSample& sample) {
            return kept(fit_sample(sample, emulators->of(sample), ensemble.space(), settings,
                                   run_seed(settings.seed, sample.row, fit_stream)),
                        sample.row);
        },
        todo, before);
}

/// Rows to confirm: all, none, or N spread evenly over those that were fitted.
std::vector<std::size_t> rows_to_confirm(const BulkStudy& study, const std::string& confirm) {
    std::vector<std::size_t> fitted;
    for (const SampleOutcome& s : study.samples)
        if (s.fit) fitted.push_back(s.row);
    if (confirm == "all") return fitted;
    const std::size_t wanted = confirm == "none" ? 0 : std::stoul(confirm);
    if (wanted >= fitted.size()) return fitted;
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < wanted; ++k) out.push_back(fitted[k * fitted.size() / wanted]);
    return out;
}

DirectRuns direct_runs_of(const BulkSample& sample, const std::vector<RunRecord>& runs) {
    DirectRuns out;
    out.asked = runs.size();
    for (const RunRecord& run : runs) {
        const bool reached =
            run.ok && run.outputs[run.outputs.size() - 1] >= static_cast<double>(sample.needed);
        if (!reached) {
            if (out.reason.empty())
                out.reason =
                    run.ok ? "axial strain passed the largest allowed, or no rest, before the last stage"
                           : run.reason;
            continue;
        }
        VectorXd t(sample.stages());
        for (Index k = 0; k < t.size(); ++k) t[k] = sample.transform.forward(run.outputs[k]);
        VectorXd curve = sample.interpolation * t;
        for (double& y : curve) y = sample.transform.inverse(y);
        out.curves.push_back(std::move(curve));
    }
    const auto n = static_cast<double>(out.curves.size());
    if (n == 0) return out;
    out.mean = VectorXd::Zero(sample.curve.strain.size());
    for (const VectorXd& curve : out.curves) out.mean += curve / n;
    if (n < 2) return out;
    out.sd = VectorXd::Zero(out.mean.size());
    for (const VectorXd& curve : out.curves) out.sd += (curve - out.mean).cwiseAbs2() / (n - 1);
    out.sd = out.sd.cwiseSqrt();
    return out;
}

void confirm(SharedEnsemble& ensemble, const Settings& settings, BulkStudy& study) {
    std::vector<DirectTrial> trials;
    for (const std::size_t row : rows_to_confirm(study, settings.confirm))
        trials.push_back(
            {row, ensemble.physical(study.samples[row].fit->estimate, *study.samples[row].sample->test)});
    if (trials.empty()) return;
    const PartTimer timer(study, "direct runs");
    const auto runs = ensemble.confirm(trials, settings.bulk.confirmation_packings);
    for (std::size_t k = 0; k < trials.size(); ++k) {
        SampleOutcome& outcome = study.samples[trials[k].row];
        outcome.direct = direct_runs_of(*outcome.sample, runs[k]);
        if (outcome.direct->curves.empty()) continue;
        const VectorXd error = outcome.direct->mean - outcome.sample->curve.strain;
        outcome.rmse = std::sqrt(error.squaredNorm() / static_cast<double>(error.size()));
        outcome.mean_error = error.mean();
    }
}

}  // namespace

PooledError pooled_error(const std::vector<const SampleOutcome*>& samples) {
    PooledError out;
    double n = 0, sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0, se = 0, see = 0;
    for (const SampleOutcome* s : samples) {
        if (!s->direct || s->direct->curves.empty()) continue;
        for (Index k = 0; k < s->direct->mean.size(); ++k) {
            const double x = s->sample->curve.strain[k], y = s->direct->mean[k];
            n += 1;
            sx += x;
            sy += y;
            sxx += x * x;
            syy += y * y;
            sxy += x * y;
            se += y - x;
            see += (y - x) * (y - x);
        }
    }
    out.readings = static_cast<std::size_t>(n);
    if (n == 0) return out;
    out.rmse = std::sqrt(see / n);
    out.mean_error = se / n;
    const double vx = sxx - sx * sx / n, vy = syy - sy * sy / n;
    if (vx > 0 && vy > 0) out.pearson_r = (sxy - sx * sy / n) / std::sqrt(vx * vy);
    return out;
}

BulkStudy run_study(SharedEnsemble& ensemble, const lab_data::DataSet& set, const Settings& settings,
                    const std::filesystem::path& folder, RunLog& log) {
    BulkStudy study;
    study.samples.resize(set.rows.size());
    for (std::size_t row = 0; row < set.rows.size(); ++row) {
        SampleOutcome& outcome = study.samples[row];
        outcome.row = row;
        if (set.rows[row].readable()) continue;
        outcome.status = "unreadable";
        outcome.reason = std::get<lab_data::UserError>(set.rows[row].test).what();
    }
    const Index first = std::max<Index>({fewest_training_runs(static_cast<int>(ensemble.inputs())),
                                         std::llround(first_share * settings.runs),
                                         settings.method == "inverse-kriging" ? settings.runs : 0});
    {
        const PartTimer timer(study, "training runs");
        study.training = ensemble.train(std::min<Index>(first, settings.runs));
    }
    std::vector<std::pair<std::size_t, std::string>> left_out;
    const std::vector<BulkSample> samples = bulk_samples(ensemble, set, settings, left_out);
    for (auto& [row, reason] : left_out) {
        study.samples[row].status = "failed";
        study.samples[row].reason = std::move(reason);
    }
    for (const BulkSample& sample : samples) study.samples[sample.row].sample = sample;
    if (samples.empty()) throw std::runtime_error("no sample of the data set can be fitted");
    if (settings.runs > first)
        for (RunRecord& run :
             further_runs(ensemble, settings, study.training, samples, settings.runs - first, study))
            study.training.push_back(std::move(run));
    fit_all(ensemble, settings, samples, folder, study);
    confirm(ensemble, settings, study);
    for (SampleOutcome& outcome : study.samples) judge(outcome, ensemble.space());
    std::vector<const SampleOutcome*> all;
    for (const SampleOutcome& outcome : study.samples) all.push_back(&outcome);
    study.overall = pooled_error(all);
    study.warnings = ensemble.warnings();
    for (const Part& part : study.parts) log.write(fmt::format("{}: {:.1f} s", part.name, part.seconds));
    for (const std::string& text : study.emulators) log.write(text);
    return study;
}

}  // namespace loam::experiments
