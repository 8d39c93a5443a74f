// How much slower than its usual rate a test is driven where the servo that holds a stress lags behind.
#pragma once

#include <algorithm>

namespace loam::experiments {

/// Rigid or strongly dilating specimens lose and gain stress faster than a servo follows: where the stress is
/// missed by more than two thirds of what is tolerable (1 % on average), lately, the test is slowed down,
/// to a tenth at the least.
class Care {
  public:
    /// Of the usual rate, 0.1 to 1.
    double factor() const { return factor_; }

    /// `error` of the held stress, relative, at one stretch.
    void look(double error) {
        constexpr double tolerable = 0.01, memory = 100, least = 0.1;
        recent_ += (error - recent_) / memory;
        if (recent_ > 0.65 * tolerable) factor_ = std::max(least, 0.98 * factor_);
        if (recent_ < 0.5 * tolerable) factor_ = std::min(1.0, 1.01 * factor_);
    }

  private:
    double factor_ = 1, recent_ = 0;
};

}  // namespace loam::experiments
