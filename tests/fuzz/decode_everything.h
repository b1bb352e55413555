// SPDX-License-Identifier: MIT
/// Decodes an input of a fuzzer as one of the values that processes store for each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/order/local_spacing.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/part/stored_graph.h"
#include "pointsweep/part/tile.h"
#include "pointsweep/part/tile_catalogue.h"
#include "pointsweep/pipeline/checkpoint/checkpoints.h"
#include "pointsweep/pipeline/run/task_values.h"
#include "pointsweep/sweep/sweep.h"

namespace pointsweep {

/// An open forest whose votes have two bytes each.
struct VotedForest {
  static VotedForest decode(Decoder& in) { return {decode_open_forest(in, 2)}; }
  void encode(Encoder& out) const { pointsweep::encode(out, forest); }

  OpenForest forest;
};

/// Decodes a value and encodes it. Aborts unless the value decoded from this encoding has the same encoding.
template <class T>
void decode_and_encode(std::span<const std::byte> bytes) {
  const std::vector<std::byte> again = encoded<const T>(decoded<T>(bytes));
  if (encoded<const T>(decoded<T>(again)) != again) std::abort();
}

inline constexpr void (*kDecode[])(std::span<const std::byte>) = {
    decode_and_encode<Survey>,        decode_and_encode<LocalSpacing>, decode_and_encode<SweepProgress>,
    decode_and_encode<Checkpoint>,    decode_and_encode<TileIndex>,    decode_and_encode<TileCatalogue>,
    decode_and_encode<TileState>,     decode_and_encode<TileBorder>,   decode_and_encode<VotedForest>,
    decode_and_encode<PiecesOfRange>, decode_and_encode<FilesOfRanges>};

/// The first byte chooses the type of the value that the other bytes hold. An Error is a valid answer. Findings are
/// other exceptions, crashes, and memory allocated for more list elements than the input has bytes for.
inline void decode_everything(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return;
  try {
    kDecode[bytes[0] % std::size(kDecode)](std::as_bytes(std::span(bytes, size)).subspan(1));
  } catch (const Error&) {
  }
}

}  // namespace pointsweep
