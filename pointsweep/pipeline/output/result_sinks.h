// SPDX-License-Identifier: MIT
/// Sinks in which the finished points of a sweep wait until the output is written (the deferred write Φ_W, paper
/// Section 4.2.1).
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/order/row_store.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/pipeline/plan/output_layout.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

/// A sink for Order::input: stores result records by input row. The result of input row `first_row` is stored as row 0.
class InputOrderSink final : public Sink {
 public:
  InputOrderSink(RowStore& store, std::uint32_t result_bytes, std::uint64_t first_row = 0)
      : store_(store), result_bytes_(result_bytes), first_row_(first_row) {}
  void finished(const Finished& points) override {
    const std::span<const std::byte> results(points.results, points.size * result_bytes_);
    if (first_row_ == 0) return store_.put({points.rows, points.size}, results);
    std::vector<std::uint64_t> rows(points.rows, points.rows + points.size);
    for (std::uint64_t& row : rows) row -= first_row_;
    store_.put(rows, results);
  }

 private:
  RowStore& store_;
  std::uint32_t result_bytes_;
  std::uint64_t first_row_;
};

/// A sink for Order::sweep: stores whole output records by their place in the canonical order.
class SweepOrderSink final : public Sink {
 public:
  SweepOrderSink(RowStore& store, const Stream& stream, const OutputLayout& layout, std::uint32_t input_stride);
  bool wants_records() const override { return true; }
  void slab_read(std::uint32_t slab, std::vector<std::byte> records) override;
  void finished(const Finished& points) override;
  void recalled(const Finished& points) override;
  void deferred(std::uint32_t slab, std::uint32_t index_in_slab) override;
  void were_finished(std::uint32_t slab, std::uint64_t points) override { leave(slab, points); }

 private:
  struct Kept {
    std::uint64_t place;
    std::vector<std::byte> record;
  };
  /// A slab with points, `left` of them, that are neither finished nor deferred.
  struct Open {
    std::vector<std::byte> records;
    std::vector<std::uint32_t> rank;  ///< place of each point in the canonical order of its slab
    std::uint64_t left;
  };
  void store(const Finished& points, const std::vector<std::byte>& inputs, const std::vector<std::uint64_t>& places);
  void leave(std::uint32_t slab, std::uint64_t points);

  RowStore& store_;
  const Stream& stream_;
  const OutputLayout& layout_;
  std::uint32_t input_stride_;
  std::mutex mutex_;
  /// By slab: null before the slab is read, and once all its points are finished or deferred.
  std::vector<std::shared_ptr<Open>> slabs_;
  /// Deferred points, which Recall (sweep/recall.h) finishes after the sweep, by slab and index in the slab.
  std::map<std::pair<std::uint32_t, std::uint32_t>, Kept> kept_;
};

}  // namespace pointsweep
