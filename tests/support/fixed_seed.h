// SPDX-License-Identifier: MIT
/// Property tests that try the same values in every run: include this beside <rapidcheck.h>.
#pragma once

#include <cstdlib>

namespace pointsweep {

/// RapidCheck reads its seed from here when the first property is checked; one set by the caller is left alone.
inline const int kSeedIsFixed = ::setenv("RC_PARAMS", "seed=20050923", 0);

}  // namespace pointsweep
