// SPDX-License-Identifier: MIT
#include "pointsweep/levels/curve_points.h"

#include <algorithm>

namespace pointsweep {
namespace {

/// A scratch in memory that consists of blocks, so that it grows without copying.
class BlocksInMemory final : public Scratch {
 public:
  void append(std::span<const std::byte> bytes) override {
    while (!bytes.empty()) {
      if (size_ % kBlock == 0) blocks_.emplace_back().reserve(std::min(kBlock, std::max(bytes.size(), kLeast)));
      const std::size_t n = std::min(bytes.size(), kBlock - size_ % kBlock);
      blocks_.back().insert(blocks_.back().end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
      size_ += n;
      bytes = bytes.subspan(n);
    }
  }
  void read(std::uint64_t offset, std::span<std::byte> bytes) const override {
    for_each_part(offset, bytes.size(), [&](std::size_t block, std::size_t at, std::size_t done, std::size_t n) {
      std::copy_n(blocks_[block].data() + at, n, bytes.data() + done);
    });
  }
  void replace(std::uint64_t offset, std::span<const std::byte> bytes) override {
    for_each_part(offset, bytes.size(), [&](std::size_t block, std::size_t at, std::size_t done, std::size_t n) {
      std::copy_n(bytes.data() + done, n, blocks_[block].data() + at);
    });
  }

 private:
  static constexpr std::size_t kBlock = 1 << 20, kLeast = 4096;

  template <class Use>
  static void for_each_part(std::uint64_t offset, std::size_t bytes, const Use& use) {
    for (std::size_t done = 0; done < bytes;) {
      const std::uint64_t place = offset + done;
      const std::size_t at = place % kBlock, n = std::min(bytes - done, kBlock - at);
      use(static_cast<std::size_t>(place / kBlock), at, done, n);
      done += n;
    }
  }

  std::vector<std::vector<std::byte>> blocks_;
  std::size_t size_ = 0;
};

}  // namespace

std::unique_ptr<Scratch> ScratchRoom::make(std::uint64_t expected) {
  if (files_ && expected > memory_) return files_();
  memory_ -= std::min(memory_, expected);
  return std::make_unique<BlocksInMemory>();
}

void CurvePoints::add(std::span<const std::byte> records, std::size_t record_bytes) {
  const std::size_t rows = records.size() / record_bytes;
  added_.resize(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    added_[i] = point_of(&records[i * record_bytes]);
    if ((count_ + i) % kBlockRows == 0) bounds_.push_back({added_[i], added_[i]});
    bounds_.back().include(added_[i]);
  }
  scratch_->append(std::as_bytes(std::span(added_)));
  count_ += rows;
}

void CurvePoints::read(std::uint64_t first, std::span<GridPoint> points) const {
  scratch_->read(first * sizeof(GridPoint), std::as_writable_bytes(points));
}

Box CurvePoints::block_box(std::uint64_t block) const {
  const GridBounds& bounds = bounds_[static_cast<std::size_t>(block)];
  return {grid_.place(bounds.lo), grid_.place(bounds.hi)};
}

}  // namespace pointsweep
