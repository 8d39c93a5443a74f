// What is believed of one parameter before the data: a truncated density, and the coordinate in which it is
// fitted. The coordinate x in [0,1] runs between the truncation bounds, linear in the value (normal, uniform)
// or in its log10 (lognormal, loguniform); in x every prior is a truncated normal or a uniform density.
#pragma once

namespace loam::surrogate {

enum class PriorKind { normal, lognormal, uniform, loguniform };

struct Prior {
    PriorKind kind = PriorKind::uniform;
    double mean = 0;   ///< of the value, or of its log10 for lognormal; unused for uniform and loguniform
    double sd = 0;     ///< likewise
    double lower = 0;  ///< truncation, in the value's own unit
    double upper = 1;

    /// Throws std::invalid_argument naming field, value and constraint: finite numbers, lower < upper, lower
    /// > 0 on a log scale, sd > 0 for the normal kinds, and bounds that hold at least 1e-100 of the normal's
    /// mass.
    void validate() const;

    /// The coordinate of a value, and back; inverse of each other up to rounding. No clamping outside the
    /// bounds.
    double to_unit(double value) const;
    double from_unit(double x) const;

    // The truncated distribution of the coordinate x. All expect a valid prior.
    double quantile_unit(double u) const;     ///< x below which the share u lies; accurate in tails
    double cdf_unit(double x) const;          ///< the share below x; x is clamped to [0,1]
    double log_density_unit(double x) const;  ///< integrates to one over [0,1]; -infinity outside
    double log_density_derivative_unit(double x) const;  ///< its derivative for x in [0,1]
    double mean_unit() const;
    double sd_unit() const;
};

}  // namespace loam::surrogate
