// SPDX-License-Identifier: MIT
/// The descriptors behind standard_streams.h.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <span>

#include "pointsweep/program/standard_streams.h"

namespace pointsweep {

/// Returns the descriptor that take_standard_input() has made readable; -1 before.
int standard_input_descriptor();

/// Writes like write(2). Streams other than regular files get small pieces, so that a request to stop is noticed while
/// the reader is slow; then throws Cancelled.
ssize_t write_to_stream(int descriptor, std::span<const std::byte> bytes);

}  // namespace pointsweep
