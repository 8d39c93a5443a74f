// A vector of numbers as JSON.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <vector>

namespace loam::experiments {

/// The values of `v` as a JSON array; one that is not finite is written as null.
inline nlohmann::json values_of(const Eigen::Ref<const Eigen::VectorXd>& v) {
    return std::vector<double>(v.begin(), v.end());
}

}  // namespace loam::experiments
