// SPDX-License-Identifier: MIT
/// Wrong on purpose: the tool does not know the engine. The layer check must refuse it.
#include "pointsweep/sweep/window.h"
