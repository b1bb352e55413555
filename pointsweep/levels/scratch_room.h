// SPDX-License-Identifier: MIT
/// Scratch in memory as far as a number of bytes goes, and in the temporary folder beyond it.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "pointsweep/points/scratch.h"

namespace pointsweep {

class ScratchRoom {
 public:
  /// Without `files`, all is in memory.
  ScratchRoom(std::uint64_t memory_bytes, MakeScratch files) : memory_(memory_bytes), files_(std::move(files)) {}

  /// Makes a scratch for about `expected` bytes.
  std::unique_ptr<Scratch> make(std::uint64_t expected);
  bool has_files() const { return files_ != nullptr; }
  const MakeScratch& files() const { return files_; }

 private:
  std::uint64_t memory_;  ///< that is left
  MakeScratch files_;
};

}  // namespace pointsweep
