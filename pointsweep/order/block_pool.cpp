// SPDX-License-Identifier: MIT
#include "pointsweep/order/block_pool.h"

#include <algorithm>
#include <cassert>

namespace pointsweep {
namespace {

constexpr std::size_t kAlignment = 64;
constexpr std::size_t kLeastPiece = std::size_t{256} << 10, kLargestPiece = std::size_t{32} << 20;

}  // namespace

BlockPool::BlockPool(std::size_t block_bytes)
    : block_bytes_((block_bytes + kAlignment - 1) / kAlignment * kAlignment) {}

std::byte* BlockPool::take() {
  const std::lock_guard lock(mutex_);
  std::byte* block = nullptr;
  if (!free_.empty()) {
    block = free_.back();
    free_.pop_back();
  } else {
    if (pieces_.empty() || piece_used_ == pieces_.back().size()) {
      const std::size_t aim = std::clamp(held_ / 4, kLeastPiece, kLargestPiece);  // keeps the unused memory small
      pieces_.emplace_back(std::max<std::size_t>(1, aim / block_bytes_) * block_bytes_);
      held_ += pieces_.back().size();
      piece_used_ = 0;
    }
    block = pieces_.back().data() + piece_used_;
    piece_used_ += block_bytes_;
  }
  ++taken_;
  return block;
}

void BlockPool::give_back(std::byte* block) {
  const std::lock_guard lock(mutex_);
  free_.push_back(block);
  --taken_;
}

void BlockPool::clear() {
  const std::lock_guard lock(mutex_);
  assert(taken_ == 0);
  free_.clear();
  pieces_.clear();
  held_ = 0;
}

std::size_t BlockPool::taken_bytes() const {
  const std::lock_guard lock(mutex_);
  return taken_ * block_bytes_;
}

}  // namespace pointsweep
