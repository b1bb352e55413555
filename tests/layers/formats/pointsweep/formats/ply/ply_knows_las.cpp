// SPDX-License-Identifier: MIT
/// Wrong on purpose: a format knows no other format. The layer check must refuse it.
#include "pointsweep/formats/las/las_header.h"
