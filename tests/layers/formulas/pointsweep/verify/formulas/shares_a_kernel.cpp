// SPDX-License-Identifier: MIT
#include "pointsweep/math/symmetric3.h"
#include "pointsweep/verify/formulas/estimate.h"
