// The loops of kernel.hpp for one instruction set; the flags stand in engine/CMakeLists.txt.
#include "engine/kernel/kernel.inc"

LOAM_KERNEL_TABLE(kernel_baseline, effects_baseline, "baseline")
