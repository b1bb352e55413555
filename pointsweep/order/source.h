// SPDX-License-Identifier: MIT
/// Sources of points, independent of files and formats, and readers of their rows: in blocks by one thread, or in
/// sequence by all threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/threads.h"

namespace pointsweep {

/// Fills `records` with rows from `row` on and returns the number of rows read, like Reader::read().
using ReadRows = std::function<std::size_t(std::uint64_t row, std::span<std::byte> records)>;

/// The rows of a cloud: their schema, their number, and functions that read them.
struct PointSource {
  Schema schema;
  std::uint64_t count = 0;
  ReadRows read;  ///< reads rows; called by one thread at a time
  /// Returns a function that reads rows for one thread, while other threads read with their own functions. It fills
  /// only the `wanted` fields, or all fields if `wanted` is empty. Returns an empty function if only one thread at a
  /// time can read.
  std::function<ReadRows(const std::vector<std::size_t>& wanted)> for_thread = {};
  /// Returns the end of the chunk of rows (compressed together, for example) that one thread should read from `row` on,
  /// or `row` if the rows may be split anywhere.
  std::function<std::uint64_t(std::uint64_t row)> chunk_end = {};
};

/// Fills `records` (whole records) from `row` on. Throws Error if the source has fewer rows.
void read_fully(const PointSource& source, std::uint64_t row, std::span<std::byte> records);
/// Fills `records` (whole records) from `row` on with `read` instead of source.read. Throws Error if the source has
/// fewer rows.
void read_fully(const PointSource& source, const ReadRows& read, std::uint64_t row, std::span<std::byte> records);

/// Returns the indices of the fields x, y and z.
std::vector<std::size_t> position_columns(const Schema& schema);

/// A reader of blocks of rows for one thread, which also decodes their positions. Other threads use their own readers.
class BlockReader {
 public:
  /// `wanted`: the required fields; empty: all. The source must outlive the reader and have for_thread().
  BlockReader(const PointSource& source, const std::vector<std::size_t>& wanted);

  /// Reads `rows` rows from `first_row` on. Throws Error if the source has fewer rows.
  void read(std::uint64_t first_row, std::size_t rows);

  /// Returns the number of rows of the last read().
  std::size_t count() const { return count_; }
  Vec3 position(std::size_t i) const { return {numbers_[i], numbers_[count_ + i], numbers_[2 * count_ + i]}; }
  const std::byte* records() const { return records_.data(); }

 private:
  const PointSource& source_;
  PositionFields fields_;
  ReadRows read_;
  std::size_t count_ = 0;
  std::vector<std::byte> records_;
  std::vector<double> numbers_;  ///< x, then y, then z
};

/// Reads a source on all threads, each with its own reader. One reader reads all rows of a chunk
/// (PointSource::chunk_end), even if two calls of read() share the chunk. If only one thread at a time can read the
/// source, one reader reads all rows.
class ParallelRows {
 public:
  explicit ParallelRows(PointSource source) : source_(std::move(source)) {}

  /// Returns whether each thread has its own reader, so that other threads may read the source at the same time.
  bool is_parallel();
  /// Fills `records` (whole records) from `row` on. Throws Error if the source has fewer rows. Not thread-safe.
  void read(std::uint64_t row, std::span<std::byte> records);

 private:
  struct Piece {
    std::uint64_t row, end;
    std::size_t reader;
  };
  std::vector<Piece> pieces_of(std::uint64_t row, std::uint64_t end);

  PointSource source_;
  std::vector<ReadRows> readers_;  ///< empty: not made yet
  std::size_t next_ = 0;           ///< index of the reader for the chunk in which the next call begins
};

/// Number of rows for a task that works only on data in memory.
inline constexpr std::size_t kTaskRows = 4096;

/// Calls work(first, n) for tasks that cover rows [0, rows), on all threads.
template <class Work>
void for_each_task(std::size_t rows, const Work& work) {
  parallel_for_blocks(rows, kTaskRows, [&](std::size_t first, std::size_t n, unsigned) { work(first, n); });
}

/// Returns how many rows of `bytes` bytes all threads together should take at once: 1 MiB of rows, up to 4 MiB for many
/// threads.
std::size_t rows_at_once(std::size_t bytes);

}  // namespace pointsweep
