// SPDX-License-Identifier: MIT
/// The instruction sets for which vector code is built; the best available one is chosen at run time. A file with
/// vector code must include this header before any header of Highway. On x86-64: the baseline, SSE4, AVX2 and AVX-512;
/// others would only add code of the same speed. Vectors whose size is unknown at compile time (SVE, RISC-V) cannot be
/// members of a struct, which our kernels need; such machines run NEON or scalar code. Sanitizers use only the baseline
/// and AVX2, since every set costs minutes of compilation there. With POINTSWEEP_INSTRUCTION_SETS=native
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
