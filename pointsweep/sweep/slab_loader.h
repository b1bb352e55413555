// SPDX-License-Identifier: MIT
/// Reads slabs of the ordered stream (order/stream.h) and cuts them into cells (the read operator Φ_R, paper Section
/// 4.2.1).
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "pointsweep/order/stream.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/row_error.h"
#include "pointsweep/search/cut.h"
#include "pointsweep/sweep/plan.h"
#include "pointsweep/sweep/window.h"

namespace pointsweep {

struct LoadScratch;

struct LoadedSlab {
  std::vector<std::unique_ptr<WindowCell>> cells;  ///< cells of the slab, ascending by number
  std::vector<std::byte> records;                  ///< records of the slab if `keep_records`, else empty
};

/// Reads slabs and cuts them into cells. A slab gives equal cells every time, so that a resumed run finds the cells of
/// the earlier run. Thread-safe.
class SlabLoader {
 public:
  SlabLoader(const Stream& stream, const SweepPlan& plan, std::uint32_t cell_points);
  ~SlabLoader();
  /// Returns the cells of a slab, with estimates of their reaches (expect_reaches()).
  LoadedSlab load(std::uint32_t slab, bool keep_records) const;
  /// Cuts some points of a slab into cells, all with the number 0: `records` holds their records, and `index_in_slab`
  /// their indices in the slab.
  std::vector<std::unique_ptr<WindowCell>> cells_of(std::uint32_t slab, std::span<const std::uint32_t> index_in_slab,
                                                    const std::vector<std::byte>& records) const;
  /// Returns the error of the lowest loaded row, halos excepted (Slab::is_halo), with a value that the type expected by
  /// a stage cannot hold; empty if there is no such row.
  FirstRowError refused() const;

 private:
  std::vector<std::unique_ptr<WindowCell>> cut_into_window_cells(std::uint32_t slab,
                                                                 const std::vector<std::byte>& records,
                                                                 LoadScratch& scratch) const;
  std::unique_ptr<WindowCell> make_cell(std::uint32_t slab, std::span<const CutPoint> points,
                                        const std::vector<std::byte>& records,
                                        std::vector<std::byte>& cell_records) const;
  void fill_file_columns(const std::vector<std::byte>& cell_records, WindowCell& cell) const;

  const Stream& stream_;
  const SweepPlan& plan_;
  std::uint32_t cell_points_;
  PositionFields position_;
  Field row_;
  class OwnScratch;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<LoadScratch>> free_;  ///< buffers of calls that have ended, for later calls
  mutable FirstRowError refused_;
};

/// Fills `out` with the values of a file column, in the type that operators expect, for records of `schema` whose rows
/// are `rows`. Notes in `refused` values that this type cannot hold.
void fill_file_column(const FileColumn& file, const Schema& schema, const std::byte* records,
                      std::span<const std::uint64_t> rows, std::byte* out, FirstRowError& refused);

}  // namespace pointsweep
