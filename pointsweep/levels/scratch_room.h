// SPDX-License-Identifier: MIT
/// A source of scratches (points/scratch.h). They lie in memory up to a number of bytes in all, then in the temporary
/// folder.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "pointsweep/points/scratch.h"

namespace pointsweep {

class ScratchRoom {
 public:
  /// Without `files`, all scratches are in memory.
  ScratchRoom(std::uint64_t memory_bytes, MakeScratch files) : memory_(memory_bytes), files_(std::move(files)) {}

  /// Makes a scratch for about `expected` bytes.
  std::unique_ptr<Scratch> make(std::uint64_t expected);
  bool has_files() const { return files_ != nullptr; }
  const MakeScratch& files() const { return files_; }

 private:
  std::uint64_t memory_;  ///< bytes that are left
  MakeScratch files_;
};

}  // namespace pointsweep
