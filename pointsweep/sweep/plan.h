// SPDX-License-Identifier: MIT
/// The plan of a sweep: stages, steps and columns. Every attribute name is already resolved to a column number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <vector>

#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/search/best_list.h"

namespace pointsweep {

/// The time for which the values of a column are needed.
enum class Lifetime : std::uint8_t {
  none,  ///< no stage reads the column, and the column is not written to the output
  step,  ///< later stages of the same step read the value at the point itself, or the value is written to the output
  cell,  ///< needed as long as the point is in memory
};

/// An operator at its place in the chain (the paper's Φ_k). Columns are numbered; remaking an attribute makes a new
/// column, so that no stage overwrites values that another stage may still read at a neighbour.
struct Stage {
  StageOperator op;
  std::vector<std::uint16_t> reads, reads_neighbors, makes;
  int position = -1;  ///< column of the moved positions that the stage sees; negative: positions of the input

  /// Returns `op` if it is a connecting stage, which emits edges instead of filling its columns; else null.
  const ConnectOperator* connects() const {
    const auto* connecting = std::get_if<std::shared_ptr<const ConnectOperator>>(&op);
    return connecting != nullptr ? connecting->get() : nullptr;
  }
};

/// A column whose values come from fields of the stream's records, converted to the type that operators expect.
struct FileColumn {
  std::uint16_t column;
  std::vector<std::size_t> fields;  ///< indices of the fields, one for each component
  Type type;                        ///< type that the operator expects; values are converted to it
};

/// A made column that a later pass or the output needs. Its values are copied to `offset` of the result records.
struct ResultColumn {
  std::uint16_t column;
  std::uint32_t offset;
  std::uint32_t bytes;
};

struct SweepPlan {
  Neighborhood neighborhood;
  std::vector<std::uint16_t> rule_reads = {};  ///< columns of neighborhood.rule->reads(), all of them from the file
  std::vector<Stage> stages;
  /// Stages run in steps: step s is stages [steps[s], steps[s+1]). A step begins with the search (step 0) or with a
  /// pre-buffered stage, which runs on a cell once all neighbours of its points have finished the step before. Further
  /// stages of the step are through-buffered: they run at once, while the cell is in cache (paper Section 5.2).
  std::vector<std::size_t> steps;
  std::vector<std::uint32_t> column_bytes;  ///< for each column, bytes of the value of one point
  std::vector<Lifetime> lifetimes;          ///< lifetime of each column; a file column has the lifetime `cell`
  std::vector<FileColumn> file_columns;
  std::vector<ResultColumn> results;
  std::uint32_t result_bytes = 0;

  std::size_t step_count() const { return steps.size() - 1; }
  /// Returns the bytes of the columns that a point has as long as it is in memory.
  std::uint64_t cell_lifetime_bytes() const {
    std::uint64_t bytes = 0;
    for (std::size_t c = 0; c < column_bytes.size(); ++c)
      if (lifetimes[c] == Lifetime::cell) bytes += column_bytes[c];
    return bytes;
  }
  /// Returns an upper bound of the bytes of a point's columns that are dropped at the end of their step.
  std::uint64_t step_lifetime_bytes() const {
    return std::accumulate(column_bytes.begin(), column_bytes.end(), std::uint64_t{0}) - cell_lifetime_bytes();
  }
};

/// A batch of finished points.
struct Finished {
  std::uint32_t slab;
  const std::uint32_t* index_in_slab;  ///< for each point, the index of its record in the slab
  const std::uint64_t* rows;           ///< for each point, its row in the input
  const std::byte* results;            ///< one result record of SweepPlan::result_bytes for each point
  std::size_t size;
};

/// Receives finished points: the deferred-write operator Φ_W (paper Section 4.2.1). Each point, except in slabs of a
/// halo (Slab::is_halo), is passed once to finished() or recalled(), unless an earlier process of a resumed run has
/// passed it. Many threads may call both functions at once.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual void finished(const Finished& points) = 0;
  /// Receives points that the sweep deferred and the recall has finished. Calls finished() unless overridden.
  virtual void recalled(const Finished& points) { finished(points); }
  /// Reports that a point of `slab` will be finished only after the whole stream has been read. Must be thread-safe.
  virtual void deferred(std::uint32_t slab, std::uint32_t index_in_slab) {
    (void)slab;
    (void)index_in_slab;
  }
  /// Returns whether the sink takes the records of the slabs (Stream::record_schema()). If so, slab_read() is called
  /// with the records of a slab before any point of the slab is finished.
  virtual bool wants_records() const { return false; }
  virtual void slab_read(std::uint32_t slab, std::vector<std::byte> records) {
    (void)slab;
    (void)records;
  }
  /// Reports that `points` points of a slab were finished before the run was resumed. Called after slab_read() for the
  /// slab, and only if wants_records(). Need not be called for a slab of which all points were finished.
  virtual void were_finished(std::uint32_t slab, std::uint64_t points) {
    (void)slab;
    (void)points;
  }
};

}  // namespace pointsweep
