// SPDX-License-Identifier: MIT
/// Which instruction sets kernels are generated for; included before any header of Highway in a file with vector code.
/// Vectors whose size is unknown at compile time (SVE, RISC-V) cannot be members of a struct, which our kernels want;
/// such machines run the NEON or scalar code. On x86-64: the baseline by static dispatch, SSSE3 to AVX-512 chosen at
/// run time.
#pragma once

#include <hwy/detect_targets.h>

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
