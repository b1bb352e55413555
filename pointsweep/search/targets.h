// SPDX-License-Identifier: MIT
/// The instruction sets that vector code is built for, the best of which is taken at run time: SSE4, AVX2 and AVX-512
/// on x86, besides plain scalar code; others would only add code of the same speed.
#pragma once

#include <hwy/detect_targets.h>

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
