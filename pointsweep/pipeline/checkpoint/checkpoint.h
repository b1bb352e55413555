// SPDX-License-Identifier: MIT
/// The state of a run when its last checkpoint was made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/statistics.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {

/// The state of a run at a checkpoint. During a pass, `stream` is set first, when the points are in order. During the
/// sweep, `results` and `progress` are set, too. After the sweep only `results` is set. None of the three is set after
/// the update, when the results have become the rows of the next pass.
struct Checkpoint {
  std::uint64_t memory_bytes = 0;           ///< the budget, for a resumed run that states none
  Survey survey;                            ///< survey of the input, from which a resumed run also plans its memory
  std::uint64_t sweep = 0;                  ///< pass to begin, or to go on with; rows carried into it are complete
  std::uint64_t slab_points = 0;            ///< intended number of points of a slab of `stream`
  std::vector<std::byte> stream;            ///< encoded Stream; empty before the points are in order, and after the
                                            ///< sweep
  std::vector<Vec3> bucket_places;          ///< places between the buckets of edges of the pass
  std::vector<std::byte> results;           ///< encoded RowStore; empty before the first slab
  std::vector<std::byte> progress;          ///< encoded SweepProgress; empty before the first slab
  std::uint64_t mask = 0;                   ///< pass that begins with the rows of the last select; 0: all rows remain
  std::vector<std::vector<double>> values;  ///< known values of the whole cloud, by number; empty: not known
  Statistics counts;                        ///< counts of the finished sweeps, for take_counts()

  bool is_in_order() const { return !stream.empty(); }
  bool is_swept() const { return stream.empty() && !results.empty(); }

  void encode(Encoder& out) const;
  static Checkpoint decode(Decoder& in);
};

/// Copies the counts of sweeps and of points of all kinds; copies neither times nor bytes nor series.
void take_counts(Statistics& to, const Statistics& from);

}  // namespace pointsweep
