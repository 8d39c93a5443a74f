#include "experiments/bulk/method_comparison.hpp"

#include <omp.h>

#include <algorithm>
#include <exception>

#include "experiments/bulk/inverse_kriging.hpp"

namespace loam::experiments {
namespace {

constexpr std::size_t most_compared = 125;

}  // namespace

MethodComparison compare_methods(const SharedEnsemble& ensemble, const GroupEmulators& emulators,
                                 const std::vector<BulkSample>& samples, const Settings& settings,
                                 const BulkStudy& study) {
    std::vector<const BulkSample*> fitted;
    for (const BulkSample& sample : samples) {
        const SampleOutcome& outcome = study.samples[sample.row];
        const bool stands = !outcome.direct || !outcome.direct->curves.empty();
        if (outcome.fit && stands) fitted.push_back(&sample);
    }
    const std::size_t n = std::min(most_compared, fitted.size());
    std::vector<std::optional<CurvePair>> kriging(n), emulator(n);
    InverseKriging method(ensemble, study.training);
#pragma omp parallel for schedule(dynamic) \
    num_threads(settings.jobs > 0 ? settings.jobs : omp_get_max_threads())
    for (std::size_t k = 0; k < n; ++k) {
        const BulkSample& sample = *fitted[k * fitted.size() / n];
        try {
            const FittedSample fit = method.fit(sample);
            kriging[k] = {sample.curve.strain,
                          predicted_curve(sample, emulators.of(sample), ensemble.space(), fit.estimate)};
            emulator[k] = {sample.curve.strain, study.samples[sample.row].fit->predicted};
        } catch (const std::exception&) {
            // Too few runs reached this sample's stages, or they do not differ there; no reason to end a
            // study.
        }
    }
    MethodComparison out;
    std::vector<CurvePair> a, b;
    for (std::size_t k = 0; k < n; ++k) {
        if (!kriging[k]) continue;
        a.push_back(*emulator[k]);
        b.push_back(*kriging[k]);
    }
    out.samples = a.size();
    out.emulator = pooled_error(a);
    out.inverse_kriging = pooled_error(b);
    return out;
}

}  // namespace loam::experiments
