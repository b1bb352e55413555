// SPDX-License-Identifier: MIT
/// Splitting of slabs that are too large because many points share a coordinate or the sample missed a dense place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/order/slab_store.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

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
  std::size_t most_pieces = 2;   ///< most pieces that one pass makes of a piece
  std::size_t buffer_bytes = 0;  ///< bytes of the buffers of a pass
};

/// Splits `pieces`, which ascend in canonical order, until none contains more than `most` points. Keeps the order of
/// the pieces. The parts of a piece ascend along the coordinate by which it is split. Working records of the schema
/// `working` are streamed from list to list; no piece is loaded as a whole.
std::vector<StreamPiece> split_large_pieces(const std::vector<StreamPiece>& pieces, const Schema& working,
                                            const SplitOptions& options, SlabStore& store);

/// Moves the records of a list to a new list in ascending row and returns the number of the new list. Holds about
/// `options.most` records in memory at a time.
std::size_t sort_list_by_row(std::size_t list, const Schema& working, const SplitOptions& options, SlabStore& store);

}  // namespace pointsweep
