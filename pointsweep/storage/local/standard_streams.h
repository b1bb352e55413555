// SPDX-License-Identifier: MIT
/// Standard input as an input file and standard output as an output file. Both are called "-".
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <span>

namespace pointsweep {

/// Returns whether a path means standard input (as an input) or standard output (as an output): "-". A file of that
/// name is "./-".
bool is_standard_stream(const std::filesystem::path& path);

/// Returns whether the path of an output means standard output: "-", or "-" and the extension of a format, "-.csv".
bool is_standard_output(const std::filesystem::path& path);

/// Makes standard input readable at any offset as InputFile("-"): a pipe is copied to a file without a name in `folder`
/// (empty: the system's temporary folder), with 1 MB of memory. Must be called before the file is opened; later calls
/// are no-ops. Throws Error if standard input is a terminal, or the folder has no space for it.
void take_standard_input(const std::filesystem::path& folder);

/// Returns the descriptor that take_standard_input() has made readable; -1 before.
int standard_input_descriptor();

/// Writes like write(2). Streams other than regular files get small pieces, so that a request to stop is noticed while
/// the reader is slow; then throws Cancelled.
ssize_t write_to_stream(int descriptor, std::span<const std::byte> bytes);

}  // namespace pointsweep
