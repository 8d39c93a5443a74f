#include "surrogate/statistics/semivariogram.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace loam::surrogate {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The best nugget and sill >= 0 for that range, and the weighted squares left.
double fit_linear(const ExperimentalSemivariogram& e, GaussianSemivariogram& model) {
    const VectorXd shape = (1 - (-(e.distance / model.range).array().square()).exp()).matrix();
    const double w = e.pairs.sum(), wx = e.pairs.dot(shape), wy = e.pairs.dot(e.value),
                 wxx = e.pairs.dot(shape.cwiseAbs2()), wxy = e.pairs.dot(shape.cwiseProduct(e.value));
    const double det = w * wxx - wx * wx;
    model.sill = det > 1e-12 * w * wxx ? (w * wxy - wx * wy) / det : 0;
    model.nugget = (wy - model.sill * wx) / w;
    if (model.sill < 0) {
        model.sill = 0;
        model.nugget = wy / w;
    } else if (model.nugget < 0) {
        model.nugget = 0;
        model.sill = wxx > 0 ? wxy / wxx : 0;
    }
    const VectorXd left = e.value - (model.nugget + model.sill * shape.array()).matrix();
    return e.pairs.dot(left.cwiseAbs2());
}

}  // namespace

double GaussianSemivariogram::at(double h) const {
    return h == 0 ? 0 : nugget + sill * -std::expm1(-(h / range) * (h / range));
}

ExperimentalSemivariogram experimental_semivariogram(const VectorXd& predictor, const VectorXd& values,
                                                     int bins) {
    const Index n = predictor.size();
    if (n != values.size() || n < 3)
        throw std::invalid_argument("semivariogram: needs as many values as predictors, at least 3");
    const double reach = 0.5 * (predictor.maxCoeff() - predictor.minCoeff());
    if (!(reach > 0)) throw std::invalid_argument("semivariogram: the predictor is constant");
    VectorXd distance = VectorXd::Zero(bins), value = distance, pairs = distance;
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < i; ++j) {
            const double h = std::abs(predictor[i] - predictor[j]);
            if (h >= reach) continue;
            const Index bin = static_cast<Index>(h / reach * bins);
            distance[bin] += h;
            value[bin] += 0.5 * (values[i] - values[j]) * (values[i] - values[j]);
            pairs[bin] += 1;
        }
    ExperimentalSemivariogram out;
    const Index filled = (pairs.array() > 0).count();
    out.distance.resize(filled);
    out.value.resize(filled);
    out.pairs.resize(filled);
    Index at = 0;
    for (Index b = 0; b < bins; ++b) {
        if (pairs[b] == 0) continue;
        out.distance[at] = distance[b] / pairs[b];
        out.value[at] = value[b] / pairs[b];
        out.pairs[at++] = pairs[b];
    }
    return out;
}

GaussianSemivariogram fit_gaussian(const ExperimentalSemivariogram& e) {
    const double longest = e.distance.maxCoeff();
    GaussianSemivariogram best;
    double least = std::numeric_limits<double>::infinity();
    // The range is the only number that enters nonlinearly: a grid over two decades, then finer about its
    // best.
    double low = std::log(0.02 * longest), high = std::log(3 * longest);
    for (int pass = 0; pass < 4; ++pass) {
        constexpr int grid = 40;
        const double step = (high - low) / grid;
        for (int k = 0; k <= grid; ++k) {
            GaussianSemivariogram model{.range = std::exp(low + k * step)};
            const double left = fit_linear(e, model);
            if (left < least) {
                least = left;
                best = model;
            }
        }
        const double at = std::log(best.range);
        low = at - step;
        high = at + step;
    }
    return best;
}

}  // namespace loam::surrogate
