// SPDX-License-Identifier: MIT
/// Not compiled: a public header that includes an internal one, for the test of cmake/check_layers.cmake.
#pragma once

#include "pointsweep/points/with_type.h"
