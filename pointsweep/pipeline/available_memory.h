// SPDX-License-Identifier: MIT
/// The memory that a run without a stated budget may count on.
#pragma once

#include <cstdint>
#include <filesystem>

namespace pointsweep {

/// Returns the number of bytes available to this process: MemAvailable of the system, or less if the control group of
/// the process, or a group around it, has less left of its memory limit. Cached pages of files count as left, as they
/// do in MemAvailable. `root`: the folder that has proc/ and sys/.
std::uint64_t available_memory(const std::filesystem::path& root = "/");

/// Returns `asked_for`; if it is 0, half of available_memory().
std::uint64_t memory_budget(std::uint64_t asked_for);

}  // namespace pointsweep
