#include "experiments/diagnosis/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/diagnosis/thresholds.hpp"

namespace loam::experiments {
namespace {

bool predicts(const Finalist& f) {
    return f.held_out_gain >= thresholds::gain_over_base && f.gap_shrinks && f.is_physical && f.is_present;
}

bool is_viable(const Finalist& f) {
    return f.fit_p > thresholds::fit_p && f.gap <= thresholds::largest_gap && predicts(f);
}

double margin(const Finalist& rival, const Finalist& best) {
    return rival.is_mundane && !best.is_mundane ? thresholds::gain_over_mundane_rival
                                                : thresholds::gain_over_rival;
}

Verdict outside(const std::vector<Finalist>& finalists) {
    const auto passes = [](const Finalist& f) { return f.fit_p > thresholds::fit_p; };
    const bool some_fit = std::ranges::any_of(finalists, passes);
    return {VerdictKind::outside_library,
            {},
            some_fit ? "an effect fits the measurements, but does not predict curves that were left out, or "
                       "needs a strength or parameters that are not physical"
                     : "no effect of the library makes the model follow the measurements within their noise"};
}

}  // namespace

std::string_view to_string(VerdictKind kind) {
    switch (kind) {
        case VerdictKind::none:
            return "none";
        case VerdictKind::named:
            return "named";
        case VerdictKind::ambiguous:
            return "ambiguous";
        case VerdictKind::outside_library:
            return "outside_library";
    }
    return "";
}

Verdict decide(bool alarm, bool can_hold_out, const std::vector<Finalist>& finalists) {
    if (!alarm) return {VerdictKind::none, {}, "the model follows the measurements within their noise"};
    std::vector<Finalist> viable;
    if (!can_hold_out) {
        // Without curves to predict, an effect that fits is a suspicion at most.
        for (const Finalist& f : finalists)
            if (f.fit_p > thresholds::fit_p && f.is_physical && f.is_present) viable.push_back(f);
        std::ranges::sort(viable, std::greater{}, &Finalist::log_evidence);
        if (viable.empty()) return outside(finalists);
        Verdict out{
            VerdictKind::ambiguous, {}, "there is one curve alone, so that no prediction can be tried"};
        for (const Finalist& f : viable) out.effects.push_back(f.effect);
        return out;
    }
    std::ranges::copy_if(finalists, std::back_inserter(viable), is_viable);
    if (viable.empty()) return outside(finalists);
    std::ranges::sort(viable, std::greater{}, &Finalist::held_out_gain);
    const Finalist best = viable.front();
    std::vector<Finalist> own, rivals;
    // What predicts as well but does not fit is no answer, yet may be the better half of one: a rival.
    for (const Finalist& f : finalists) {
        if (!(predicts(f) && (is_viable(f) || f.group != best.group))) continue;
        const bool close = f.held_out_gain > best.held_out_gain - margin(f, best);
        if (!close) continue;
        (f.group == best.group ? own : rivals).push_back(f);
    }
    std::ranges::sort(own, std::greater{}, &Finalist::log_evidence);
    Verdict out;
    if (rivals.empty()) {
        out.kind = VerdictKind::named;
        out.reason = "the model with the effect follows the measurements and predicts the curves left out";
        for (const Finalist& f : own) out.effects.push_back(f.effect);
        return out;
    }
    out.kind = VerdictKind::ambiguous;
    out.reason =
        "several effects explain the measurements and predict the curves left out about equally well";
    own.insert(own.end(), rivals.begin(), rivals.end());
    std::ranges::stable_sort(own, std::greater{}, &Finalist::is_mundane);
    for (const Finalist& f : own) out.effects.push_back(f.effect);
    return out;
}

bool is_hopeless(double explained, const std::vector<Finalist>& so_far) {
    return std::ranges::any_of(so_far, [&](const Finalist& f) {
        return is_viable(f) && explained < thresholds::hopeless_share * f.log_evidence &&
               explained < f.log_evidence - thresholds::hopeless_lag;
    });
}

std::vector<double> probabilities(const std::vector<Finalist>& finalists) {
    std::vector<double> logs;
    double largest = 0;
    for (const Finalist& f : finalists) {
        logs.push_back(f.log_evidence);
        largest = std::max(largest, f.log_evidence);
    }
    // "None of them" is as probable as the best of them is improbable by its own test.
    double best_p = 0;
    for (const Finalist& f : finalists)
        if (f.log_evidence >= largest) best_p = f.fit_p;
    std::vector<double> out;
    double sum = 0;
    for (const double value : logs) {
        out.push_back(std::exp(value - largest));
        sum += out.back();
    }
    const double share = std::clamp(best_p / thresholds::fit_p, 0.0, 1.0);
    for (double& value : out) value *= sum > 0 ? share / sum : 0;
    out.push_back(1 - (sum > 0 ? share : 0));
    return out;
}

}  // namespace loam::experiments
