// SPDX-License-Identifier: MIT
/// Wrong on purpose: operators/kinds may not include operators/surface. The layer check must refuse this file.
#include "pointsweep/operators/surface/normals.h"
