// SPDX-License-Identifier: MIT
/// The macro that marks exported symbols of the shared library. All other symbols are hidden.
#pragma once

#if defined(__GNUC__)
#define POINTSWEEP_EXPORT __attribute__((visibility("default")))
#else
#define POINTSWEEP_EXPORT
#endif
