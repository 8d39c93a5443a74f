#include "experiments/effects/test_models.hpp"

#include <math.h>  // what pchip.hpp calls without std::

#include <algorithm>
#include <boost/math/interpolators/pchip.hpp>
#include <cmath>
#include <vector>

namespace loam::experiments {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd device_strain(const VectorXd& load, double compliance) {
    return compliance * load;
}

VectorXd bedding_strain(const VectorXd& load, double amount, double scale) {
    VectorXd out(load.size());
    double largest = 0;
    for (Index k = 0; k < load.size(); ++k) {
        largest = std::max(largest, load[k]);
        out[k] = -amount * std::expm1(-largest / scale);
    }
    return out;
}

VectorXd mean_ring_stress(const VectorXd& top, double beta, double seating) {
    if (beta == 0) return top;
    const double down = -std::expm1(-beta) / beta;  // mean of exp(-beta z) over 0..1
    const double up = std::expm1(beta) / beta;
    VectorXd out(top.size());
    double now = seating;
    for (Index k = 0; k < top.size(); ++k) {
        now = std::clamp(now, down * top[k], up * top[k]);
        out[k] = now;
    }
    return out;
}

VectorXd at_shifted_readings(const VectorXd& x, const VectorXd& added, const VectorXd& values) {
    if ((added.array() == 0).all() || !values.allFinite()) return values;
    std::vector<double> at{0.0}, y{0.0};
    for (Index k = 0; k < x.size(); ++k) {
        // A device that gives back more than the piston moves would snap; the reading before it stands.
        const double moved = x[k] + added[k];
        if (moved <= at.back()) continue;
        at.push_back(moved);
        y.push_back(values[k]);
    }
    if (at.size() < 4) return values;  // too few readings for a curve
    const double last = at.back(), final = y.back();
    const boost::math::interpolators::pchip<std::vector<double>> curve(std::move(at), std::move(y));
    VectorXd out(x.size());
    for (Index k = 0; k < x.size(); ++k) out[k] = x[k] < last ? curve(x[k]) : final;
    return out;
}

}  // namespace loam::experiments
