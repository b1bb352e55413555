// SPDX-License-Identifier: MIT
/// The instruction sets that vector code is built for, the best of which is taken at run time; included before any
/// header of Highway in a file with vector code. On x86-64: the baseline, SSE4, AVX2 and AVX-512; the others would only
/// add code of the same speed. Vectors whose size is unknown at compile time (SVE, RISC-V) cannot be members of a
/// struct, which our kernels want; such machines run NEON or scalar code. Under sanitizers the baseline and AVX2 do,
/// since every set costs minutes of compilation there. With POINTSWEEP_INSTRUCTION_SETS=native
/// (cmake/instruction_sets.cmake) the build leaves out the sets below the best one of its machine, but never the
/// baseline.
#pragma once

#include <hwy/detect_targets.h>

#undef HWY_DISABLED_TARGETS
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#else
#ifndef POINTSWEEP_SETS_LEFT_OUT
#define POINTSWEEP_SETS_LEFT_OUT HWY_SSSE3
#endif
#define HWY_DISABLED_TARGETS \
  (POINTSWEEP_SETS_LEFT_OUT | HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
