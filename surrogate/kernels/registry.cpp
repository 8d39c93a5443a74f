#include "surrogate/kernels/registry.hpp"

#include <array>
#include <stdexcept>
#include <string>

#include "surrogate/dense/dense.hpp"

namespace loam::surrogate {
namespace {

using Eigen::ArrayXd;
using Eigen::Ref;

void matern52(const Ref<const ArrayXd>& squared_distance, Ref<ArrayXd> value, Ref<ArrayXd> slope) {
    dense_functions().matern52(static_cast<int>(squared_distance.size()), squared_distance.data(),
                               value.data(), slope.data());
}

void squared_exponential(const Ref<const ArrayXd>& squared_distance, Ref<ArrayXd> value, Ref<ArrayXd> slope) {
    dense_functions().squared_exponential(static_cast<int>(squared_distance.size()), squared_distance.data(),
                                          value.data(), slope.data());
}

constexpr std::array all_kernels{
    KernelInfo{"matern52", "twice differentiable functions; forgiving where the response bends sharply",
               "Rasmussen & Williams 2006, eq. 4.17", matern52},
    KernelInfo{"squared_exponential", "infinitely differentiable functions",
               "Rasmussen & Williams 2006, eq. 4.9", squared_exponential},
};

}  // namespace

std::span<const KernelInfo> kernels() {
    return all_kernels;
}

const KernelInfo& find_kernel(std::string_view name) {
    std::string known;
    for (const KernelInfo& kernel : all_kernels) {
        if (kernel.name == name) return kernel;
        known += (known.empty() ? "" : ", ") + std::string(kernel.name);
    }
    throw std::invalid_argument("kernel: '" + std::string(name) + "' is unknown; choose one of " + known);
}

}  // namespace loam::surrogate
