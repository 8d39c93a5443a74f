#include "experiments/bulk/fitting.hpp"

#include <omp.h>

#include <atomic>
#include <exception>
#include <functional>
#include <stdexcept>

#include "experiments/bulk/fit_journal.hpp"
#include "experiments/bulk/inverse_kriging.hpp"
#include "experiments/bulk/part_timer.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/output/progress.hpp"

namespace loam::experiments {
namespace {

constexpr std::uint64_t fit_stream = 32;

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

}  // namespace

std::optional<GroupEmulators> fit_samples(SharedEnsemble& ensemble, const Settings& settings,
                                          const std::vector<BulkSample>& samples,
                                          const std::filesystem::path& journal_path, BulkStudy& study) {
    FitJournal journal(journal_path);
    std::vector<const BulkSample*> todo;
    for (const BulkSample& sample : samples) {
        const auto at = journal.found().find(sample.row);
        if (at == journal.found().end())
            todo.push_back(&sample);
        else
            study.samples[sample.row].fit = at->second;
    }
    Fitting fitting(settings, journal, study);
    const std::size_t before = samples.size() - todo.size();
    if (settings.method == "inverse-kriging") {
        const PartTimer timer(study, "fits");
        InverseKriging kriging(ensemble, study.training);
        fitting.run([&](const BulkSample& sample) { return kriging.fit(sample); }, todo, before);
        return std::nullopt;
    }
    std::optional<GroupEmulators> emulators;
    {
        const PartTimer timer(study, "emulators");
        emulators.emplace(ensemble, study.training, samples, settings);
    }
    const PartTimer timer(study, "fits");
    fitting.run(
        [&](const BulkSample& sample) {
            return kept(fit_sample(sample, emulators->of(sample), ensemble.space(), settings,
                                   run_seed(settings.seed, sample.row, fit_stream)),
                        sample.row);
        },
        todo, before);
    return emulators;
}

}  // namespace loam::experiments
