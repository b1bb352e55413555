// SPDX-License-Identifier: MIT
/// The instruction sets for which vector code is built; the best available one is chosen at run time. A file with
/// vector code must include this header before any header of Highway. On x86-64 these sets are the baseline, SSE4, AVX2
/// and AVX-512; other sets would add code without adding speed. SVE and RISC-V are left out: the size of their vectors
/// is unknown at compile time, so that the vectors cannot be members of a struct, as our kernels require. Machines with
/// these sets run NEON or scalar code. Builds with sanitizers contain only the baseline and AVX2, since every set takes
/// them minutes to compile. With POINTSWEEP_INSTRUCTION_SETS=native (cmake/instruction_sets.cmake) the build on a
/// machine with AVX2 or AVX-512 keeps only the baseline and the best set of that machine.
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
