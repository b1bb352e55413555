// SPDX-License-Identifier: MIT
/// Partition of points into pieces of the stream (stream.h), on all threads: one pass over all points, and passes that
/// split too large pieces. A piece is too large if many points share a coordinate or the sample missed a dense place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/order/local_spacing.h"
#include "pointsweep/order/pieces.h"
#include "pointsweep/order/slab_store.h"
#include "pointsweep/order/working_record.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// The key that assigns a point to a piece: a coordinate, or its input row as a double (exact below 2^53).
enum class SortKey : std::uint8_t { x, y, z, row };

/// Fills `records` with consecutive records, from number `first` on.
using ReadRecords = std::function<void(std::uint64_t first, std::span<std::byte> records)>;

/// The input of one pass: the records, and the pieces into which they are divided.
struct PartitionInput {
  const Schema& schema;  ///< schema of the records read
  std::uint64_t count;
  ReadRecords read;             ///< called by one thread at a time, in order
  const WorkingRecord& record;  ///< makes the stored record from a record read
  SortKey key;
  /// One Splitters for all points, or one for points in dense places and one for points in sparse places. The pieces of
  /// the second are numbered after those of the first.
  std::span<const Splitters> splitters;
  std::size_t first_list;                     ///< piece p goes to list first_list + p of the store
  std::optional<std::size_t> nonfinite_list;  ///< list for nonfinite points; absent: all points must be finite
  std::size_t memory_bytes;                   ///< bytes that all buffers of the pass should take together
  const LocalSpacing* spacing = nullptr;      ///< tells which places are sparse; null if there is one Splitters
  /// Returns a function that replaces `read` for one thread, or an empty function. Threads call their own functions at
  /// the same time.
  std::function<ReadRecords()> for_thread = {};
  std::function<std::uint64_t(std::uint64_t row)> chunk_end = {};  ///< see PointSource::chunk_end
  std::function<void(std::uint64_t rows)> progress = {};  ///< called with the number of records read so far, by one
                                                          ///< thread at a time
};

/// Appends each record to the list of its piece, and returns the tight boxes of the pieces. The points of a piece and
/// its box do not depend on the number of threads.
std::vector<Box> distribute(const PartitionInput& input, SlabStore& store);

/// The records of one list of a store: a contiguous piece of the stream whose records are in no order.
struct StreamPiece {
  std::size_t list = 0;
  std::uint64_t count = 0;
  Box box;
  std::uint64_t least_row = 0;  ///< lower bound of the rows of all records
};

struct SplitOptions {
  int axis = 0;
  bool canonical = true;         ///< pieces are split along the axis first; else along the coordinate of widest spread
  std::uint64_t aim = 1;         ///< number of points that a piece should have
  std::uint64_t most = 1;        ///< pieces with at most this many points are not split
  std::size_t most_pieces = 2;   ///< most parts into which one pass splits a piece
  std::size_t buffer_bytes = 0;  ///< bytes of the buffers of a pass
};

/// Splits `pieces`, which ascend in canonical order, until none contains more than `most` points. Keeps the order of
/// the pieces. The parts of a piece ascend along the coordinate by which it is split. Passes stream the working
/// records, of the schema `working`, from list to list; no piece is loaded as a whole.
std::vector<StreamPiece> split_large_pieces(const std::vector<StreamPiece>& pieces, const Schema& working,
                                            const SplitOptions& options, SlabStore& store);

/// Moves the records of a list to a new list, ascending by row, and returns the number of the new list. Holds two
/// copies of at most `options.most` records in memory. `options.canonical` must be true.
std::size_t sort_list_by_row(std::size_t list, const Schema& working, const SplitOptions& options, SlabStore& store);

}  // namespace pointsweep
