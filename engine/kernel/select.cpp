#include <cstdlib>
#include <cstring>

#include "engine/kernel/kernel.hpp"

namespace loam::engine {
namespace {

const KernelTable& choose_kernel() {
    const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    const bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                            __builtin_cpu_supports("avx512vl") && has_avx2;
    const char* wish = std::getenv("LOAM_KERNEL");
    if (wish != nullptr && std::strcmp(wish, "baseline") == 0) return kernel_baseline;
    if (wish != nullptr && std::strcmp(wish, "avx2") == 0 && has_avx2) return kernel_avx2;
    return has_avx512 ? kernel_avx512 : has_avx2 ? kernel_avx2 : kernel_baseline;
}

}  // namespace

const KernelTable& select_kernel() {
    static const KernelTable& chosen = choose_kernel();
    return chosen;
}

}  // namespace loam::engine
