// SPDX-License-Identifier: MIT
/// A fixed seed for property tests, so that they use the same values in every run. Include this header and
/// <rapidcheck.h>.
#pragma once

#include <cstdlib>

namespace pointsweep {

/// RapidCheck reads its seed from this variable when the first property is checked; a seed set by the caller is kept.
inline const int kSeedIsFixed = ::setenv("RC_PARAMS", "seed=20050923", 0);

}  // namespace pointsweep
