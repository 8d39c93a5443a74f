// The loops of kernel.hpp over contacts with effects, for one instruction set; the flags stand in
// engine/CMakeLists.txt.
#include "engine/kernel/effects.inc"

LOAM_EFFECTS_TABLE(effects_baseline)
