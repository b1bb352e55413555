// SPDX-License-Identifier: MIT
/// File descriptors of the streams that program/standard_streams.h declares.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <span>

#include "pointsweep/program/standard_streams.h"

namespace pointsweep {

/// Returns the descriptor from which standard input is read; -1 until take_standard_input() has been called.
int standard_input_descriptor();

/// Writes like write(2). Streams other than regular files get small pieces, so that a request to stop is noticed while
/// the reader is slow. Throws Cancelled on such a request.
ssize_t write_to_stream(int descriptor, std::span<const std::byte> bytes);

}  // namespace pointsweep
