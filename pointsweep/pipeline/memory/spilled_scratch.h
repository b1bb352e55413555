// SPDX-License-Identifier: MIT
/// Scratch in a file of the temporary folder that has no name.
#pragma once

#include "pointsweep/order/spill_file.h"
#include "pointsweep/order/temp_folder.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

class SpilledScratch final : public Scratch {
 public:
  explicit SpilledScratch(const TempFolder& folder) : file_(&folder) {}
  void append(std::span<const std::byte> bytes) override { file_.write(file_.reserve(bytes.size()), bytes); }
  void read(std::uint64_t offset, std::span<std::byte> bytes) const override { file_.read(offset, bytes); }

 private:
  SpillFile file_;
};

}  // namespace pointsweep
