// SPDX-License-Identifier: MIT
/// Starts runs from the library's own code: over an InputCloud, with options for tests, scripts and reports that users
/// do not need.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/run.h"

namespace pointsweep {

/// The way in which a run puts its points in order: a distribution pass copies all points into slabs, or each slab is
/// made on demand, when the sweep reads it (docs/adr/0011).
enum class Ordering : std::uint8_t {
  planned,       ///< as the memory plan decides
  distribution,  ///< always by a distribution pass
  on_demand,     ///< on demand wherever possible, even if many points wait in memory for their slabs
};

/// RunOptions with further options of the engine. No result depends on the further options.
struct EngineOptions : RunOptions {
  EngineOptions() = default;
  EngineOptions(const RunOptions& options) : RunOptions(options) {}

  std::uint64_t slab_points = 0;  ///< intended points of a slab; 0: chosen from the cloud
  /// Slabs that are read together if memory allows. 0: chosen from the number of threads, or 1 if slab_points is set.
  std::uint32_t slabs_per_turn = 0;
  std::uint32_t cell_points =
      1024;  ///< most points of a cell, a unit of work (search/cell.h); a multiple of 16 up to 2,048
  Ordering ordering = Ordering::planned;
  std::uint64_t block_rows = 0;  ///< for slabs on demand: rows that are decoded together; 0: chosen
  bool spill = false;            ///< use the temporary folder even if memory suffices
  /// Search neighbourhoods again for every step, even if memory suffices to keep them.
  bool search_again = false;
  /// Bytes for the lists of neighbours that a thread uses at a time. A list of one point always fits. 0: chosen from
  /// the budget.
  std::uint64_t lists_bytes = 0;
};

/// Like the functions of the same names in run.h, these functions run a chain and sort a cloud.
Statistics run(InputCloud& cloud, const Chain& chain, const Outputs& outputs, const EngineOptions& options = {});
Statistics sort(InputCloud& cloud, const std::filesystem::path& output, const EngineOptions& options = {},
                const std::vector<std::string>& keep = {});

}  // namespace pointsweep
