// SPDX-License-Identifier: MIT
/// Wrong on purpose: the tool includes a header that is not public. The layer check must refuse it.
#include "pointsweep/points/schema.h"
