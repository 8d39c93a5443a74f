/// When a search from many starts may end: an estimate of how many minima it has not seen.
#pragma once

#include <cmath>
#include <vector>

namespace loam::optimizers {

/// After n searches that ended in w different minima, the expected number of minima is w (n - 1) / (n - w -
/// 2) (Boender & Rinnooy Kan 1987, Math. Program. 37, 59-80).
class MinimaSeen {
  public:
    /// A search ended at `value`. Minima are told apart by their values alone: two of one value serve equally
    /// well.
    void add(double value) {
        ++searches_;
        for (const double seen : values_) {
            if (std::abs(value - seen) <= 1e-5 * (std::abs(seen) + 1e-3)) return;
        }
        values_.push_back(value);
    }

    /// Less than half a minimum is expected to be unseen. At the earliest after 8 searches, that all ended
    /// alike.
    bool probably_complete() const {
        const auto n = static_cast<double>(searches_), w = static_cast<double>(values_.size());
        return n > w + 2 && w * (n - 1) / (n - w - 2) < w + 0.5;
    }
    static constexpr const char* reason = "less than half a minimum is expected to be unseen";

  private:
    std::vector<double> values_;
    int searches_ = 0;
};

}  // namespace loam::optimizers
