#include "experiments/bulk/study.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "experiments/bulk/direct_trials.hpp"
#include "experiments/bulk/fitting.hpp"
#include "experiments/bulk/method_comparison.hpp"
#include "experiments/bulk/part_timer.hpp"
#include "experiments/bulk/verdict.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/settings/validation.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;

constexpr std::uint64_t sample_design_stream = 33;
// Of the training runs: those spread over the prior, which cost the most and teach the least, and those that
// the emulators of the first ones place; the rest is placed by the emulators of both.
constexpr double first_share = 0.045, second_share = 0.3;
constexpr Index placing_points = 4096;  // of the prior, among which runs are placed
constexpr Index mending_runs = 8;       // for each sample that its emulator misled
constexpr std::size_t most_mended = 100;

/// Points [count x d] where the samples' posteriors lie by the emulators of the runs so far: the prior is
/// much wider than any data set, and an emulator must be good where it is asked.
Eigen::MatrixXd likely_design(const SharedEnsemble& ensemble, const Settings& settings,
                              const std::vector<RunRecord>& runs, const std::vector<BulkSample>& samples,
                              Index count, std::uint64_t place) {
    Eigen::MatrixXd points(count, ensemble.space().dimension());
    const GroupEmulators emulators(ensemble, runs, samples, settings, placing_points);
    const auto n = static_cast<Index>(samples.size());
    const Index each = (count + n - 1) / n;
#pragma omp parallel for schedule(dynamic) \
    num_threads(settings.jobs > 0 ? settings.jobs : omp_get_max_threads())
    for (Index k = 0; k < std::min(n, count); ++k) {
        // With more samples than runs, every so many samples has one.
        const BulkSample& sample = samples[static_cast<std::size_t>(k * n / std::min(n, count))];
        const std::uint64_t seed =
            run_seed(run_seed(settings.seed, sample.row, sample_design_stream), place, 0);
        const GroupEmulator& group = emulators.of(sample);
        Eigen::MatrixXd mine;
        try {
            mine = likely_points(sample, group, ensemble.space(), each, seed);
        } catch (const std::runtime_error&) {
            // A curve that no parameters give has no posterior; its runs go where the prior lies.
            mine.resize(each, points.cols());
            for (Index j = 0; j < each; ++j)
                mine.row(j) = group.library.col(j % group.library.cols()).head(points.cols()).transpose();
        }
        for (Index j = 0; j < each; ++j)
            if (const Index at = j * std::min(n, count) + k; at < count) points.row(at) = mine.row(j);
    }
    return points;
}

/// Makes `count` runs where the posteriors lie, or finds them in the store, and trains on them from now on.
/// `place`: how many such runs there were before.
void add_likely_runs(SharedEnsemble& ensemble, const Settings& settings,
                     const std::vector<BulkSample>& samples, Index count, Index& place, BulkStudy& study) {
    if (count <= 0) return;
    const auto first = static_cast<std::uint64_t>(place);
    auto runs = ensemble.stored_further(first, count);
    if (!runs) {
        Eigen::MatrixXd points;
        {
            const PartTimer timer(study, "design of further runs");
            points = likely_design(ensemble, settings, study.training, samples, count, first);
        }
        const PartTimer timer(study, "further training runs");
        runs = ensemble.train_at(points, first);
    }
    for (RunRecord& run : *runs) study.training.push_back(std::move(run));
    place += count;
}

/// The samples whose direct runs are not near what the emulator said of their estimates.
std::vector<std::size_t> misled_rows(const BulkStudy& study) {
    std::vector<std::size_t> out;
    for (const SampleOutcome& outcome : study.samples)
        if (out.size() < most_mended && was_misled(outcome)) out.push_back(outcome.row);
    return out;
}

/// Teaches the emulators what the direct runs showed, adds runs where those samples' posteriors lie now, and
/// fits and confirms them again, on further specimens.
void mend(SharedEnsemble& ensemble, const Settings& settings, const std::filesystem::path& folder,
          Index& place, BulkStudy& study) {
    for (int turn = 1; turn <= settings.bulk.mending_rounds; ++turn) {
        const std::vector<std::size_t> rows = misled_rows(study);
        if (rows.empty()) return;
        std::vector<BulkSample> samples;
        for (const std::size_t row : rows) {
            SampleOutcome& outcome = study.samples[row];
            samples.push_back(*outcome.sample);
            for (RunRecord& run : outcome.direct->runs) study.training.push_back(std::move(run));
            outcome.direct.reset();
        }
        add_likely_runs(ensemble, settings, samples, mending_runs * static_cast<Index>(samples.size()), place,
                        study);
        fit_samples(ensemble, settings, samples, folder / fmt::format("fits-{}.jsonl", turn + 1), study);
        confirm_samples(ensemble, settings, rows, turn, study);
        study.mended += rows.size();
    }
}

}  // namespace

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
    const bool kriging = settings.method == "inverse-kriging";
    // Some of the first runs may fail, and the rest must still make an emulator.
    const Index least = fewest_training_runs(static_cast<int>(ensemble.inputs())) * 5 / 4;
    const Index first = std::min<Index>(
        settings.runs,
        std::max<Index>(least, kriging ? settings.runs : std::llround(first_share * settings.runs)));
    {
        const PartTimer timer(study, "training runs");
        study.training = ensemble.train(first);
    }
    std::vector<std::pair<std::size_t, std::string>> left_out;
    const std::vector<BulkSample> samples = bulk_samples(ensemble, set, settings, left_out);
    for (auto& [row, reason] : left_out) {
        study.samples[row].status = "failed";
        study.samples[row].reason = std::move(reason);
    }
    for (const BulkSample& sample : samples) study.samples[sample.row].sample = sample;
    if (samples.empty()) throw std::runtime_error("no sample of the data set can be fitted");
    Index place = 0;
    const Index second = std::min<Index>(settings.runs - first, std::llround(second_share * settings.runs));
    add_likely_runs(ensemble, settings, samples, second, place, study);
    add_likely_runs(ensemble, settings, samples, settings.runs - first - second, place, study);
    const auto emulators = fit_samples(ensemble, settings, samples, folder / "fits.jsonl", study);
    if (emulators)
        for (const GroupEmulator& g : emulators->all()) study.emulators.push_back(g.description());
    confirm_samples(ensemble, settings, rows_to_confirm(study, settings.confirm), 0, study);
    if (!kriging) {
        mend(ensemble, settings, folder, place, study);
        const PartTimer timer(study, "comparison of methods");
        study.comparison = compare_methods(ensemble, *emulators, samples, settings, study);
    }
    for (SampleOutcome& outcome : study.samples) judge(outcome, ensemble.space());
    std::vector<CurvePair> direct;
    for (const SampleOutcome& outcome : study.samples)
        if (outcome.direct && !outcome.direct->curves.empty())
            direct.push_back({outcome.sample->curve.strain, outcome.direct->mean});
    study.overall = pooled_error(direct);
    study.warnings = ensemble.warnings();
    for (const Part& part : study.parts) log.write(fmt::format("{}: {:.1f} s", part.name, part.seconds));
    for (const std::string& text : study.emulators) log.write(text);
    return study;
}

}  // namespace loam::experiments
