// SPDX-License-Identifier: MIT
/// Lets the runs of the test program that includes this header use Engine::reference.
#pragma once

#include "reference/engine.h"

namespace pointsweep {

inline const bool kHasReferenceEngine = (register_reference_engine(), true);

}  // namespace pointsweep
