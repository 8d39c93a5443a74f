#include "experiments/bulk/direct_trials.hpp"

#include <cmath>

#include "experiments/bulk/part_timer.hpp"

namespace loam::experiments {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

DirectRuns direct_runs_of(const BulkSample& sample, std::vector<RunRecord> runs) {
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
    out.runs = std::move(runs);
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

}  // namespace

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

void confirm_samples(SharedEnsemble& ensemble, const Settings& settings, const std::vector<std::size_t>& rows,
                     int turn, BulkStudy& study) {
    std::vector<DirectTrial> trials;
    for (const std::size_t row : rows)
        trials.push_back(
            {row, ensemble.physical(study.samples[row].fit->estimate, *study.samples[row].sample->test)});
    if (trials.empty()) return;
    const PartTimer timer(study, "direct runs");
    auto runs = ensemble.confirm(trials, settings.bulk.confirmation_packings, turn);
    for (std::size_t k = 0; k < trials.size(); ++k) {
        SampleOutcome& outcome = study.samples[trials[k].row];
        outcome.direct = direct_runs_of(*outcome.sample, std::move(runs[k]));
        outcome.rmse = outcome.mean_error = 0;
        if (outcome.direct->curves.empty()) continue;
        const VectorXd error = outcome.direct->mean - outcome.sample->curve.strain;
        outcome.rmse = std::sqrt(error.squaredNorm() / static_cast<double>(error.size()));
        outcome.mean_error = error.mean();
    }
}

PooledError pooled_error(const std::vector<CurvePair>& curves) {
    PooledError out;
    double n = 0, sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0, se = 0, see = 0;
    for (const CurvePair& curve : curves) {
        for (Index k = 0; k < curve.measured.size(); ++k) {
            const double x = curve.measured[k], y = curve.simulated[k];
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

}  // namespace loam::experiments
