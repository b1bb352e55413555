// SPDX-License-Identifier: MIT
/// How much memory a run may take without hurting the rest of the machine.
#pragma once

#include <cstdint>
#include <filesystem>

namespace pointsweep {

/// Bytes this process could still use: what the kernel calls available, or less where a control group (a container, a
/// batch system) leaves less. 1 GiB where nothing is known. `root` is the folder that holds proc and sys.
std::uint64_t available_memory(const std::filesystem::path& root = "/");

}  // namespace pointsweep
