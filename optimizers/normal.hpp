/// The standard normal distribution function and its inverse. Inside this library only.
#pragma once

#include <boost/math/special_functions/erf.hpp>
#include <cmath>

namespace loam::optimizers {

inline double normal_probability(double z) {
    return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

/// For 0 < p < 1.
inline double normal_quantile(double p) {
    // In double precision throughout: Boost's default goes through long double at several times the cost.
    using boost::math::policies::promote_double;
    return -std::sqrt(2.0) *
           boost::math::erfc_inv(2 * p, boost::math::policies::policy<promote_double<false>>());
}

}  // namespace loam::optimizers
