// The covariance kernels that Gaussian processes may use: functions of the squared distance r^2 between two
// points whose coordinates were divided by their length scales. Options and contract tests read this table.
// To add a kernel: one header surrogate/kernels/<name>.hpp, one function of dense/ that compiles it for each
// processor, and one line of kernels() in registry.cpp.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>

namespace loam::surrogate {

/// Correlation and its derivative with respect to r^2, over an array of squared scaled distances r^2 >= 0.
/// All three have the same size; value(0) = 1, and the slope is finite at 0 (the kernel is differentiable
/// there).
using KernelFunction = void (*)(const Eigen::Ref<const Eigen::ArrayXd>& squared_distance,
                                Eigen::Ref<Eigen::ArrayXd> value, Eigen::Ref<Eigen::ArrayXd> slope);

struct KernelInfo {
    std::string_view name;
    std::string_view meaning;
    std::string_view source;
    KernelFunction evaluate;
};

/// All kernels, in a fixed order. The first is the default.
std::span<const KernelInfo> kernels();

/// The kernel of that name; throws std::invalid_argument with the names there are.
const KernelInfo& find_kernel(std::string_view name);

}  // namespace loam::surrogate
