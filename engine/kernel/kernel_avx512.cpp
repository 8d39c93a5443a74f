// The loops of kernel.hpp for one instruction set; the flags stand in engine/CMakeLists.txt.
#include "engine/kernel/kernel.inc"

LOAM_KERNEL_TABLE(kernel_avx512, effects_avx512, "avx512")
