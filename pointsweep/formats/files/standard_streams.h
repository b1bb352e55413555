// SPDX-License-Identifier: MIT
/// Standard input as an input file and standard output as an output file. Both are called "-".
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <span>

namespace pointsweep {

/// Whether a path stands for standard input (of an input) or standard output (of an output). A file of that name is
/// "./-".
bool is_standard_stream(const std::filesystem::path& path);

/// Makes standard input readable at any place, as InputFile("-"): where it is a pipe, copies it to a file without a
/// name in `folder` (empty: the system's temporary folder), in 1 MB of memory. To be called once, before the file is
/// opened; later calls do nothing. Throws Error if standard input is a terminal, or the folder has no space for it.
void take_standard_input(const std::filesystem::path& folder);

/// What take_standard_input() has made readable; -1 before.
int standard_input_descriptor();

/// As write(2), to what is no regular file in small pieces: a request to stop is seen while the program that reads them
/// waits. Throws Cancelled then.
ssize_t write_to_stream(int descriptor, std::span<const std::byte> bytes);

}  // namespace pointsweep
