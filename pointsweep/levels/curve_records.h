// SPDX-License-Identifier: MIT
/// Any number of records in the order of the Morton curve, in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/levels/level_grid.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// Records that begin with a GridPoint. Records with the same key are ordered by their bytes, so that the sequence does
/// not depend on the order of input.
///
/// Pieces of the records are sorted, each by itself. A sample of the records then divides the curve into stretches of
/// about equal numbers of records. For each stretch, its parts of all pieces are read and sorted; several stretches are
/// sorted in parallel.
class CurveRecords {
 public:
  /// `memory_bytes`: limit for the memory of this object. Without `files`, all records stay in memory, even beyond the
  /// limit.
  CurveRecords(std::size_t record_bytes, std::uint64_t memory_bytes, MakeScratch files);

  /// Returns whether `bytes` bytes of records exceed the half of `memory_bytes` that is meant for records.
  static bool puts_aside(std::uint64_t bytes, std::uint64_t memory_bytes) { return bytes > memory_bytes / 2; }

  void add(std::span<const std::byte> records);
  std::uint64_t count() const { return count_; }
  /// Returns the bounds of the records added so far. Without records, `lo` is the greatest int32 and `hi` the least.
  const GridBounds& bounds() const { return bounds_; }

  /// Sorts the records. Must be called once, after the last add().
  void sort(const LevelGrid& grid);

  using Use = std::function<void(std::span<const std::byte> records, std::span<const CurveKey> keys)>;
  /// Calls `use` with all records in order, in batches, with the key of each record. Must be called after
  /// sort(); may be called again.
  void for_each(const Use& use) const;

 private:
  struct Entry {
    CurveKey key;
    std::uint32_t row;
  };
  struct Piece {
    std::uint64_t offset = 0;  ///< offset of the piece in the scratch
    std::size_t rows = 0;
    std::vector<std::byte> held = {};      ///< empty if the piece is in the scratch
    std::vector<std::uint32_t> ends = {};  ///< for each stretch, the first row of the piece after it
  };
  struct Sorted {
    std::vector<std::byte> records;
    std::vector<CurveKey> keys;
  };
  /// The end of a stretch. It lies before all records that equal `record`, which is a record of the sample, or behind
  /// them if `is_behind`.
  struct End {
    CurveKey key;
    std::vector<std::byte> record;
    bool is_behind;
  };

  void sample(const std::byte* record);
  void begin_piece();
  void put_aside(Piece& piece);
  void choose_ends(const LevelGrid& grid);
  void sort_piece(Piece& piece, const LevelGrid& grid);
  Sorted sorted(std::vector<std::byte> records, const LevelGrid& grid) const;
  bool is_before(const CurveKey& key, const std::byte* record, const End& end) const;
  std::vector<std::byte> records_of(std::size_t stretch) const;
  std::uint64_t rows_of(std::size_t stretch) const;
  bool is_of_one_record(std::size_t stretch) const { return stretch < ends_.size() && ends_[stretch].is_behind; }
  void repeat(std::size_t stretch, const Use& use) const;

  std::size_t record_bytes_;
  std::uint64_t memory_;
  MakeScratch files_;
  std::unique_ptr<Scratch> scratch_;
  std::size_t piece_rows_, most_stretch_rows_;
  std::vector<Piece> pieces_;
  std::uint64_t count_ = 0;
  GridBounds bounds_;
  std::vector<std::byte> sample_;  ///< every sample_step_th record
  std::uint64_t sample_step_ = 1;
  std::optional<LevelGrid> grid_;
  std::vector<End> ends_;  ///< ends of all stretches but the last
};

}  // namespace pointsweep
