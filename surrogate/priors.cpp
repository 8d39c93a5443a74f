#include "surrogate/priors.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace loam::surrogate {
namespace {

bool logarithmic(PriorKind kind) {
    return kind == PriorKind::lognormal || kind == PriorKind::loguniform;
}
bool gaussian(PriorKind kind) {
    return kind == PriorKind::normal || kind == PriorKind::lognormal;
}

// Mass of the standard normal above z, accurate for large z.
double upper_tail(double z) {
    return 0.5 * boost::math::erfc(z / std::numbers::sqrt2);
}
double upper_tail_inverse(double q) {
    return std::numbers::sqrt2 * boost::math::erfc_inv(2 * q);
}

// The coordinate between the bounds seen as a standard normal z in [a, b].
struct StandardNormal {
    double a = 0, b = 0;
    bool mirrored = false;  // of the two tails the nearer one is kept as the upper, where erfc loses nothing

    explicit StandardNormal(const Prior& prior) {
        const bool log = logarithmic(prior.kind);
        const double lower = log ? std::log10(prior.lower) : prior.lower;
        const double upper = log ? std::log10(prior.upper) : prior.upper;
        a = (lower - prior.mean) / prior.sd;
        b = (upper - prior.mean) / prior.sd;
        if (b <= 0) {
            mirrored = true;
            std::swap(a, b);
            a = -a;
            b = -b;
        }
    }
    double mass() const { return upper_tail(a) - upper_tail(b); }
    double z(double x) const {
        return mirrored ? -b + x * (b - a) : a + x * (b - a);
    }  // of the unmirrored normal
};

[[noreturn]] void refuse(const char* field, double value, const char* constraint) {
    std::ostringstream message;
    message << "prior: " << field << " = " << value << ", but " << constraint;
    throw std::invalid_argument(message.str());
}

}  // namespace

void Prior::validate() const {
    if (!std::isfinite(lower)) refuse("lower", lower, "it must be finite");
    if (!std::isfinite(upper)) refuse("upper", upper, "it must be finite");
    if (!(lower < upper)) refuse("lower", lower, "it must be less than upper");
    if (logarithmic(kind) && !(lower > 0)) refuse("lower", lower, "it must be positive on a log scale");
    if (!gaussian(kind)) return;
    if (!std::isfinite(mean)) refuse("mean", mean, "it must be finite");
    if (!(sd > 0) || !std::isfinite(sd)) refuse("sd", sd, "it must be positive and finite");
    if (!(StandardNormal(*this).mass() >= 1e-100))
        refuse("mean", mean,
               "it lies so far outside the bounds that they hold no mass; move the mean or widen sd");
}

double Prior::to_unit(double value) const {
    if (logarithmic(kind)) return std::log10(value / lower) / std::log10(upper / lower);
    return (value - lower) / (upper - lower);
}

double Prior::from_unit(double x) const {
    if (logarithmic(kind)) return lower * std::pow(upper / lower, x);
    return lower + x * (upper - lower);
}

double Prior::quantile_unit(double u) const {
    u = std::clamp(u, 0.0, 1.0);
    if (!gaussian(kind)) return u;
    const StandardNormal normal(*this);
    const double below = normal.mirrored ? 1 - u : u, above = normal.mirrored ? u : 1 - u;
    // Count from the nearer end of the normal, so that a small probability is never a difference of large
    // ones.
    const double q = upper_tail(normal.b) + above * normal.mass();
    const double p = upper_tail(-normal.a) + below * normal.mass();
    // A tail beyond 38 standard deviations is zero in double precision; its end is the bound.
    double z = q <= 0.5 ? normal.b : normal.a;
    if (q <= 0.5 && q > 0) z = upper_tail_inverse(q);
    if (q > 0.5 && p > 0) z = -upper_tail_inverse(p);
    const double x = std::clamp((z - normal.a) / (normal.b - normal.a), 0.0, 1.0);
    return normal.mirrored ? 1 - x : x;
}

double Prior::cdf_unit(double x) const {
    x = std::clamp(x, 0.0, 1.0);
    if (!gaussian(kind)) return x;
    const StandardNormal normal(*this);
    if (normal.mirrored) {
        const double z = normal.a + (1 - x) * (normal.b - normal.a);
        return (upper_tail(z) - upper_tail(normal.b)) / normal.mass();
    }
    const double z = normal.z(x);
    // Difference of lower tails below the mean, of upper tails above it.
    if (z <= 0) return (upper_tail(-z) - upper_tail(-normal.a)) / normal.mass();
    if (normal.a >= 0) return (upper_tail(normal.a) - upper_tail(z)) / normal.mass();
    return 1 - (upper_tail(z) - upper_tail(normal.b)) / normal.mass();
}

double Prior::log_density_unit(double x) const {
    if (!(x >= 0 && x <= 1)) return -std::numeric_limits<double>::infinity();
    if (!gaussian(kind)) return 0;
    const StandardNormal normal(*this);
    const double z = normal.z(x);
    return -0.5 * z * z - 0.5 * std::log(2 * std::numbers::pi) +
           std::log((normal.b - normal.a) / normal.mass());
}

double Prior::log_density_derivative_unit(double x) const {
    if (!gaussian(kind)) return 0;
    const StandardNormal normal(*this);
    return -normal.z(x) * (normal.b - normal.a);
}

double Prior::mean_unit() const {
    if (!gaussian(kind)) return 0.5;
    const auto integrand = [this](double x) { return x * std::exp(log_density_unit(x)); };
    return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(integrand, quantile_unit(1e-17),
                                                                         quantile_unit(1 - 1e-16), 15, 1e-13);
}

double Prior::sd_unit() const {
    if (!gaussian(kind)) return 1 / std::sqrt(12.0);
    const double mean = mean_unit();
    const auto integrand = [this, mean](double x) {
        return (x - mean) * (x - mean) * std::exp(log_density_unit(x));
    };
    return std::sqrt(boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
        integrand, quantile_unit(1e-17), quantile_unit(1 - 1e-16), 15, 1e-13));
}

}  // namespace loam::surrogate
