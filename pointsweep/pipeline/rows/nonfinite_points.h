// SPDX-License-Identifier: MIT
/// Points with NaN or infinite coordinates: they are in no slab and are neighbours of no point. RunOptions::nonfinite
/// says whether the run sees them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/pipeline/engine_run.h"

namespace pointsweep {

/// Calls `use` for batches of the nonfinite points of the stream, by ascending row. `first` is the index of the first
/// point of the batch among all nonfinite points, and `records` are the working records of the batch.
void for_each_nonfinite(const Stream& stream,
                        const std::function<void(std::uint64_t first, std::span<const std::byte> records)>& use);

/// Returns the rows of `records`, working records of the stream.
std::vector<std::uint64_t> rows_of_records(const Stream& stream, std::span<const std::byte> records);

/// Returns the rows of the first nonfinite points of the stream, ascending, at most `most`.
std::vector<std::uint64_t> first_nonfinite_rows(const Stream& stream, std::size_t most);

/// Returns `asked` unless it is by_format. For by_format, returns `drop` if the format of Outputs::points cannot hold
/// nonfinite points (LAS), otherwise `keep`. With tiles, by_format means `drop` if the format of any tile cannot hold
/// nonfinite points and the input of that tile may have some.
Nonfinite nonfinite_rule(const InputCloud& cloud, const Outputs& outputs, Nonfinite asked);

struct FiniteInput {
  InputCloud cloud;       ///< the rows that the run uses
  NonfiniteRows dropped;  ///< the dropped rows; their count is 0 if no row was dropped
  /// Returns "Dropped 3 points whose coordinates are not finite ..."; empty if no row was dropped.
  std::string warning() const;
};

/// Returns the cloud without the points that nonfinite_rule() drops. Reads each input that can have nonfinite points
/// once, unless the rule keeps such points and all outputs can hold them. If there are nonfinite points, throws Error
/// with the first row if the rule refuses them, or keeps them although an output cannot hold them; also throws Error if
/// no other points are left.
FiniteInput finite_input(const InputCloud& cloud, const Outputs& outputs, const EngineOptions& options);

}  // namespace pointsweep
