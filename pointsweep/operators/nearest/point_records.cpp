// SPDX-License-Identifier: MIT
#include "pointsweep/operators/nearest/point_records.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "pointsweep/free_memory.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kBlockRecords = 4096, kLeastBlocks = 64;
/// Number of records that a thread copies at once.
constexpr std::size_t kCopied = 16384;

}  // namespace

PointRecords::PointRecords(std::size_t record_bytes, std::uint64_t memory_bytes, std::unique_ptr<Scratch> scratch)
    : record_bytes_(record_bytes),
      most_loaded_(
          std::max<std::size_t>(kLeastBlocks, static_cast<std::size_t>(memory_bytes / (kBlockRecords * record_bytes)))),
      scratch_(std::move(scratch)) {}

/// Counts the blocks in memory and the block being filled.
std::uint64_t PointRecords::least_bytes(std::size_t record_bytes) {
  return (kLeastBlocks + 1) * kBlockRecords * record_bytes;
}

void PointRecords::add(std::span<const std::byte> records) {
  const std::size_t block_bytes = kBlockRecords * record_bytes_;
  while (!records.empty()) {
    const std::span<const std::byte> part = records.first(std::min(records.size(), block_bytes - block_.size()));
    block_.insert(block_.end(), part.begin(), part.end());
    records = records.subspan(part.size());
    if (block_.size() == block_bytes) end_block();
  }
}

void PointRecords::finish() {
  if (!block_.empty()) end_block();
  free_memory_of(block_);
}

void PointRecords::end_block() {
  scratch_->append(block_);
  count_ += block_.size() / record_bytes_;
  blocks_.emplace_back();
  block_.clear();
}

/// Loads blocks, whose numbers ascend. Drops all other blocks if there is no room.
void PointRecords::load(std::span<const std::size_t> blocks) {
  std::vector<std::size_t> missing;
  for (const std::size_t b : blocks)
    if (blocks_[b].empty()) missing.push_back(b);
  if (loaded_.size() + missing.size() > most_loaded_)
    std::erase_if(loaded_, [&](std::size_t b) {
      const bool stays = std::ranges::binary_search(blocks, b);
      if (!stays) free_memory_of(blocks_[b]);
      return !stays;
    });
  for (const std::size_t b : missing) {
    const std::uint64_t first = std::uint64_t{b} * kBlockRecords;
    blocks_[b].resize(std::min<std::uint64_t>(kBlockRecords, count_ - first) * record_bytes_);
    scratch_->read(first * record_bytes_, blocks_[b]);
    loaded_.push_back(b);
  }
}

/// Goes through the needed blocks part by part if they do not all fit in memory.
void PointRecords::gather(std::span<const std::uint64_t> numbers, std::span<std::byte> to) {
  std::vector<bool> is_needed(blocks_.size());
  for (const std::uint64_t number : numbers)
    if (number != kNone) is_needed[number / kBlockRecords] = true;
  std::vector<std::size_t> needed;
  for (std::size_t b = 0; b < is_needed.size(); ++b)
    if (is_needed[b]) needed.push_back(b);
  for (std::size_t first = 0; first < needed.size(); first += most_loaded_) {
    load(std::span(needed).subspan(first, std::min(most_loaded_, needed.size() - first)));
    parallel_for_blocks(numbers.size(), kCopied, [&](std::size_t begin, std::size_t n, unsigned) {
      for (std::size_t i = begin; i < begin + n; ++i) {
        if (numbers[i] == kNone) continue;
        const std::vector<std::byte>& block = blocks_[numbers[i] / kBlockRecords];
        if (!block.empty())
          std::memcpy(to.data() + i * record_bytes_, block.data() + numbers[i] % kBlockRecords * record_bytes_,
                      record_bytes_);
      }
    });
  }
}

}  // namespace pointsweep
