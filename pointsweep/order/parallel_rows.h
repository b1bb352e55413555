// SPDX-License-Identifier: MIT
/// Rows of a source in sequence, read on all threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/order/source.h"
#include "pointsweep/threads.h"

namespace pointsweep {

/// Reads a source on all threads, each with its own reader. One reader reads a whole chunk, even if two calls of read()
/// share the chunk. If only one thread at a time can read the source, one reader reads all rows.
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

/// Returns how many rows of `bytes` bytes all threads take at once: about one megabyte of rows, up to four for many
/// threads.
std::size_t rows_at_once(std::size_t bytes);

}  // namespace pointsweep
