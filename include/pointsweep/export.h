// SPDX-License-Identifier: MIT
/// Marks what the shared library exports. Everything else in it is hidden.
#pragma once

#if defined(__GNUC__)
#define POINTSWEEP_EXPORT __attribute__((visibility("default")))
#else
#define POINTSWEEP_EXPORT
#endif
