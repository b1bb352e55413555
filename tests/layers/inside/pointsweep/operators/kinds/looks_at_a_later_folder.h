// SPDX-License-Identifier: MIT
/// Wrong on purpose: the kinds of stages know no operator. The layer check must refuse it.
#include "pointsweep/operators/surface/normals.h"
