#include "experiments/diagnosis/fingerprints.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace loam::experiments {

using Eigen::Index;

namespace {

double inner_product(const Projection& projection, const Fingerprint& one, const Fingerprint& other) {
    if (one.runs.packings.empty() || other.runs.packings.empty())
        return projection.inner(one.change, other.change);
    return inner_product(projection, one.runs, other.runs);
}

}  // namespace

double inner_product(const Projection& projection, const EffectChange& one, const EffectChange& other) {
    const auto n = static_cast<double>(one.packings.size()), k = static_cast<double>(other.packings.size());
    double products = n * k * projection.inner(one.mean(), other.mean()), counted = n * k;
    for (std::size_t a = 0; a < one.packings.size(); ++a)
        for (std::size_t b = 0; b < other.packings.size(); ++b) {
            if (one.packings[a] != other.packings[b]) continue;
            products -= projection.inner(one.of_packing.col(static_cast<Index>(a)),
                                         other.of_packing.col(static_cast<Index>(b)));
            counted -= 1;
        }
    return counted > 0 ? products / counted : 0.0;
}

double length_of(const Projection& projection, const EffectChange& change) {
    return std::sqrt(std::max(0.0, inner_product(projection, change, change)));
}

FingerprintTable compare_fingerprints(const Projection& projection, const std::vector<Fingerprint>& prints,
                                      double same_group) {
    const auto n = static_cast<Index>(prints.size());
    FingerprintTable out{Eigen::VectorXd(n), Eigen::MatrixXd::Zero(n, n), std::vector<int>(prints.size())};
    for (Index a = 0; a < n; ++a) {
        const Fingerprint& print = prints[static_cast<std::size_t>(a)];
        out.size[a] = std::sqrt(std::max(0.0, inner_product(projection, print, print)));
    }
    std::iota(out.group.begin(), out.group.end(), 0);
    for (Index a = 0; a < n; ++a)
        for (Index b = 0; b < n; ++b) {
            const Fingerprint &one = prints[static_cast<std::size_t>(a)],
                              &other = prints[static_cast<std::size_t>(b)];
            if (!(out.size[a] > 0 && out.size[b] > 0)) continue;
            out.cosines(a, b) =
                std::clamp(inner_product(projection, one, other) / (out.size[a] * out.size[b]), -1.0, 1.0);
            const bool either_sign = one.two_sided || other.two_sided;
            const double alike = either_sign ? std::abs(out.cosines(a, b)) : out.cosines(a, b);
            if (a == b || alike <= same_group) continue;
            const int keep = out.group[static_cast<std::size_t>(a)],
                      drop = out.group[static_cast<std::size_t>(b)];
            for (int& group : out.group)
                if (group == drop) group = keep;
        }
    return out;
}

Explained explain(const Projection& projection, const Fingerprint& print, double prior_sd) {
    Explained out;
    const double square = projection.inner(print.change, print.change);
    const double along = projection.inner(print.change, projection.model().residual);
    if (!(square > 0) || (along < 0 && !print.two_sided)) return out;
    out.strength = print.strength * along / square;
    out.chi_squared = along * along / square;
    const double spread = square * std::pow(prior_sd / print.strength, 2);
    out.log_evidence = 0.5 * (out.chi_squared * spread / (1 + spread) - std::log1p(spread));
    // Half of the symmetric prior is ruled out for a strength that cannot be negative: nearly all of the mass
    // lies on the right side where the effect matters.
    if (!print.two_sided) out.log_evidence += std::log(2.0);
    return out;
}

}  // namespace loam::experiments
