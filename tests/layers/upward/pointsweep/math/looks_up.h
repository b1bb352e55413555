// SPDX-License-Identifier: MIT
/// Wrong on purpose: math knows nothing else. The layer check must refuse it.
#pragma once

#include "pointsweep/points/schema.h"
