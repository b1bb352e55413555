// SPDX-License-Identifier: MIT
/// Splitting of slabs that are too large, since many points share a coordinate or the sample missed a dense place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/order/slab_store.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// The records of one list of a store: a run of the stream, not yet sorted within.
struct StreamPiece {
  std::size_t list = 0;
  std::uint64_t count = 0;
  Box box;
  std::uint64_t least_row = 0;  ///< least row of a record, or less
};

struct SplitOptions {
  int axis = 0;
  bool canonical = true;         ///< pieces are split across the axis first; otherwise across their longest side
  std::uint64_t aim = 1;         ///< points of a piece
  std::uint64_t most = 1;        ///< pieces with at most this many points are not split
  std::size_t most_pieces = 2;   ///< made at once
  std::size_t buffer_bytes = 0;  ///< bytes of the buffers of a pass
};

/// Splits `pieces`, which ascend in canonical order, until none contains more than `most` points. Keeps their order;
/// parts of a piece that is split across another side than the axis are ordered along that side. Working records of the
/// schema `working` are streamed from list to list; no piece is loaded as a whole.
std::vector<StreamPiece> split_large_pieces(const std::vector<StreamPiece>& pieces, const Schema& working,
                                            const SplitOptions& options, SlabStore& store);

/// Moves the records of a list to a new one in ascending row, holding at most about `options.most` of them in memory.
std::size_t sort_list_by_row(std::size_t list, const Schema& working, const SplitOptions& options, SlabStore& store);

}  // namespace pointsweep
