#include "experiments/diagnosis/regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace loam::experiments {
namespace {

using Eigen::Index;

// Of the strain at the model's peak: the curve before it is bending, not yielding; from there to as much
// beyond, it is at its peak.
constexpr double initial_until = 0.4, peak_until = 1.5;
// Of the largest strain: what lies beyond is called residual.
constexpr double residual_from = 0.8;

using Naming = std::function<std::string(Index)>;

std::vector<Region> collect(const RegionCurve& curve, const Naming& name_of) {
    std::vector<Region> out;
    for (Index k = 0; k < curve.x.size(); ++k) {
        const std::string name = name_of(k);
        auto at = std::ranges::find(out, name, &Region::name);
        if (at == out.end()) at = out.insert(out.end(), {curve.test, curve.channel, name, {}});
        at->outputs.push_back(curve.first + k);
    }
    return out;
}

/// Thirds of the first loading, by the logarithm of the stress.
std::vector<Region> of_oedometer(const RegionCurve& curve) {
    double low = INFINITY, high = 0;
    const auto phase = [&](Index k) {
        return curve.phase.empty() ? std::string("loading") : curve.phase[static_cast<std::size_t>(k)];
    };
    for (Index k = 0; k < curve.x.size(); ++k) {
        if (phase(k) != "loading") continue;
        low = std::min(low, std::log(curve.x[k]));
        high = std::max(high, std::log(curve.x[k]));
    }
    static const std::array names{"low stress", "middle stress", "high stress"};
    return collect(curve, [&](Index k) -> std::string {
        if (phase(k) != "loading") return phase(k);
        const double share = high > low ? (std::log(curve.x[k]) - low) / (high - low) : 1;
        return names[std::min<std::size_t>(2, static_cast<std::size_t>(3 * share))];
    });
}

std::vector<Region> of_stress(const RegionCurve& curve) {
    Index peak = 0;
    curve.model.maxCoeff(&peak);
    const double at = curve.x[peak], last = curve.x[curve.x.size() - 1];
    return collect(curve, [&](Index k) -> std::string {
        const double x = curve.x[k];
        if (x < initial_until * at) return "initial";
        if (x <= peak_until * at) return "peak";
        return x < residual_from * last ? "softening" : "residual";
    });
}

/// Compression is positive: the specimen contracts until the largest value.
std::vector<Region> of_volume(const RegionCurve& curve) {
    Index turn = 0;
    curve.model.maxCoeff(&turn);
    return collect(curve, [&](Index k) { return std::string(k <= turn ? "contraction" : "dilation"); });
}

}  // namespace

std::vector<Region> regions_of(const RegionCurve& curve) {
    if (curve.kind == lab_data::TestKind::oedometer) return of_oedometer(curve);
    const bool is_stress = curve.channel == "deviatoric_stress" || curve.channel == "shear_stress";
    return is_stress ? of_stress(curve) : of_volume(curve);
}

}  // namespace loam::experiments
