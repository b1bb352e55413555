// SPDX-License-Identifier: MIT
/// The files of a run that writes one output, called a tile, for each input.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/files/folders.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/pipeline/checkpoint/resume_folder.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/pipeline/output/output_set.h"
#include "pointsweep/pipeline/output/output_warnings.h"
#include "pointsweep/storage/local/unfinished_output.h"

namespace pointsweep {

struct Format;

/// Positions and bounds of all points after stages that move points, for formats that store integers.
struct MovedPoints {
  Box bounds;  ///< bounds of all tiles
  /// The grid of the inputs, if there is one. All tiles with moved points use it, as one output of all points would.
  std::optional<LasQuantization> grid;
  const RowFile* rows;   ///< records that the last pass has carried, by row
  std::size_t position;  ///< offset of the moved position in a record of `rows`: three float64
};

/// The parts of a request that all tiles of a run share.
struct TileRequest {
  InputCloud& cloud;  ///< cloud of all inputs
  const OutputNames& names;
  const Outputs& outputs;  ///< has a tile for each input
  const EngineOptions& options;
  /// Returns the provenance of the output of one input (OutputPlan::provenance).
  std::function<std::vector<std::string>(const InputCloud& input, std::size_t tile)> provenance;
  std::optional<MovedPoints> moved = std::nullopt;
  /// Largest number of tiles that are completed in the background while the next tile receives rows; limited by the
  /// memory that the plan leaves.
  std::size_t completing = 0;
  MakeScratch scratch = {};  ///< OutputPlan::scratch
};

/// Throws for errors that can be found before the work: outputs that exist or cannot be written, attributes that would
/// be overwritten, formats that cannot hold the made attributes. Skips tiles in `finished`, and checks names and
/// formats once for tiles that are alike. Makes missing folders of the tiles with `folders`.
void require_writable_tiles(const TileRequest& request, const FinishedTiles& finished, MadeFolders& folders);

/// Writes one tile for each input. Tiles receive their rows one after another; several are completed in parallel. A
/// tile has the kept rows and fields of its input, the made attributes, and the header and grid of its input (moved
/// points: MovedPoints::grid). It gets its name when it is complete. Tiles that an earlier process has finished are
/// skipped.
class TileSet {
 public:
  TileSet(const TileRequest& request, FinishedTiles finished);
  ~TileSet();

  /// Writes the next rows of the cloud with their results, like OutputSet::write_results().
  void write_results(std::span<const std::byte> results);
  /// Writes the next rows of the cloud without results.
  void write_inputs(std::uint64_t rows);
  /// Completes the remaining tiles. Must be called after the last row.
  void finish();

  /// Waits for background tasks. Returns a sentence that tells how many outputs are complete, to append to an error;
  /// empty if none is complete.
  std::string progress();
  std::uint64_t bytes_written() const { return bytes_written_; }
  std::size_t files_written() const { return complete_; }
  /// Returns the warnings of the tiles without repetition (OutputWarnings), and a sentence about tiles without rows.
  std::vector<std::string> warnings() const;

 private:
  struct Tile;
  using WriteRows = std::function<void(Tile&, std::uint64_t row, std::uint64_t skip, std::uint64_t rows)>;
  void for_each_part(std::uint64_t rows, const WriteRows& write);
  void open_next();
  OutputPlace place_of_tile(InputCloud& cloud, const Format* format, std::uint64_t first) const;
  void complete();
  template <class Work>
  static void with_rows_of_cloud(const Tile& tile, const Work& work);
  void finish_files(Tile& tile);
  void wait_for_first();
  void require_unchanged_inputs();

  TileRequest request_;
  ManyOutputs outputs_;
  FinishedTiles finished_;
  std::vector<std::uint64_t> first_row_;   ///< first row of each input, before any select
  std::uint64_t rows_opened_ = 0;          ///< rows of the cloud in the tiles that were opened
  std::size_t next_ = 0;                   ///< next tile to be opened
  std::atomic<std::size_t> complete_ = 0;  ///< number of complete tiles; background tasks increment it
  bool all_inputs_were_checked_ = false;
  std::unique_ptr<Tile> tile_;  ///< the tile that receives rows
  std::uint64_t bytes_written_ = 0;
  OutputWarnings warnings_;
  std::vector<std::string> empty_;                ///< names of tiles without rows
  std::deque<std::unique_ptr<Tile>> completing_;  ///< last member, so that tasks end before the members that they use
};

}  // namespace pointsweep
