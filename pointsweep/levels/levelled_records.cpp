// SPDX-License-Identifier: MIT
#include "pointsweep/levels/levelled_records.h"

namespace pointsweep {
namespace {

/// Bytes that all threads share, and bytes for each thread, which hold the kept points around a node, a stretch of
/// records and its sorted copy.
constexpr std::uint64_t kLeastLevelBytes = 32 << 20, kThreadBytes = 8 << 20;

std::uint64_t memory_of_records(std::uint64_t memory_bytes) { return memory_bytes / 4 * 3; }

}  // namespace

std::uint64_t least_level_bytes(unsigned threads) { return kLeastLevelBytes + threads * kThreadBytes; }

bool puts_records_aside(std::uint64_t bytes, std::uint64_t memory_bytes) {
  return CurveRecords::puts_aside(bytes, memory_of_records(memory_bytes));
}

LevelledRecords::LevelledRecords(std::size_t record_bytes, std::uint64_t memory_bytes, const MakeScratch& files)
    : record_bytes_(record_bytes),
      memory_(memory_bytes),
      records_(record_bytes, memory_of_records(memory_bytes), files),
      room_(memory_bytes / 8, files) {}

void LevelledRecords::choose(Vec3 scale) {
  grid_.emplace(records_.count() > 0 ? records_.bounds() : GridBounds{}, scale);
  spacing_ = grid_->width() / kDiscsAcrossCube;
  if (records_.count() == 0) return;
  records_.sort(*grid_);
  points_.emplace(*grid_, records_.count(), room_);
  LeafFinder finder;
  records_.for_each([&](std::span<const std::byte> records, std::span<const CurveKey> keys) {
    finder.add(keys);
    points_->add(records, record_bytes_);
  });
  choice_.emplace(*points_, finder.finish(), room_, memory_ / 8);
  choice_->run();
  spacing_ = choice_->spacing();
}

void LevelledRecords::for_each(const Use& use) {
  if (records_.count() == 0) return;
  records_.for_each([&](std::span<const std::byte> records, std::span<const CurveKey> keys) {
    for (std::size_t i = 0; i < keys.size(); ++i) use(keys[i], choice_->next_depth(), &records[i * record_bytes_]);
  });
}

}  // namespace pointsweep
