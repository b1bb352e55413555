// SPDX-License-Identifier: MIT
/// Wrong on purpose: math may include no other layer. The layer check must refuse this file.
#pragma once

#include "pointsweep/points/schema.h"
