// SPDX-License-Identifier: MIT
/// The files of a run that writes one for each input, and the list of complete ones of a resumable run.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/files/made_folders.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/order/row_file.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/pipeline/output/output_set.h"
#include "pointsweep/pipeline/output/output_warnings.h"
#include "pointsweep/storage/local/unfinished_output.h"

namespace pointsweep {

/// A list in the folder of checkpoints. A tile is listed by the inode of its unfinished file just before that gets its
/// name, and by inode, size and time of change once it has the name. So a process that is resumed knows each tile that
/// is complete, whenever the process before it ended, and takes no other file of that name for one.
class FinishedTiles {
 public:
  /// Reads the list that earlier processes have left. With an empty `resume_folder`, nothing is listed.
  explicit FinishedTiles(const std::filesystem::path& resume_folder);

  bool has(std::size_t tile, const std::filesystem::path& output) const;
  /// To be called when everything is written to the unfinished file of `output`, before it gets its name. Throws Error
  /// if the list cannot be written, as end() does.
  void begin(std::size_t tile, const std::filesystem::path& output);
  /// To be called when `output` has its name.
  void end(std::size_t tile, const std::filesystem::path& output);

 private:
  struct File {
    std::uint64_t device = 0, inode = 0;
    std::uint64_t bytes = 0;
    std::int64_t changed = 0;  ///< ns; 0: it had no name yet when it was listed
  };
  static bool find(const std::filesystem::path& path, File& file);
  void add(std::size_t tile, const File& file);

  std::filesystem::path list_;
  std::map<std::size_t, File> files_;
};

struct Format;

/// Positions and bounds of the points of all tiles after stages that move points, for formats that store integers.
struct MovedPoints {
  Box bounds;  ///< of all tiles
  /// The grid of the inputs, if there is one, so that all tiles with moved points and the merged cloud get the same.
  std::optional<LasQuantization> grid;
  const RowFile* rows;   ///< what the last pass has left
  std::size_t position;  ///< where a record of it has the moved position, three float64
};

/// The parts of a request that all tiles of a run share.
struct TileRequest {
  InputCloud& cloud;  ///< of all inputs
  const OutputNames& names;
  const Outputs& outputs;  ///< a tile for each input
  const EngineOptions& options;
  /// Returns the processing record for the output made of the cloud of one input (OutputPlan::provenance).
  std::function<std::vector<std::string>(const InputCloud& input, std::size_t tile)> provenance;
  std::optional<MovedPoints> moved = std::nullopt;
  /// The most tiles that are completed in the background while the next tile gets its rows; limited by the memory.
  std::size_t completing = 0;
  MakeScratch scratch = {};  ///< OutputPlan::scratch
};

/// Throws for faults that are known before the work: outputs that exist or cannot be written, attributes that would be
/// overwritten, formats that cannot hold the made attributes. Makes the folders of the tiles in `folders`.
void require_writable_tiles(const TileRequest& request, const FinishedTiles& finished, MadeFolders& folders);

/// Tiles get their rows one after the other and are completed side by side. Each has the rows, the fields, the grid and
/// the header of its input, not those of the cloud, and gets its name when it is complete. Tiles that an earlier
/// process has finished stay.
class TileSet {
 public:
  TileSet(const TileRequest& request, FinishedTiles finished);
  ~TileSet();

  /// Writes the next rows of the cloud with their results, like OutputSet::write_results().
  void write_results(std::uint64_t first_row, std::span<const std::byte> results);
  /// Writes the next rows of the cloud, for which no results were made.
  void write_inputs(std::uint64_t first_row, std::uint64_t rows);
  /// All rows have come: completes the tiles that have none.
  void finish();

  /// Returns an addition to the sentence of an error: how many outputs are complete. Empty if none is complete.
  std::string progress();
  std::uint64_t bytes_written() const { return bytes_written_; }
  std::size_t files_written() const { return complete_; }
  /// A sentence for each thing that a tile cannot hold, with the number of other tiles that share it; and how many
  /// tiles have no rows.
  std::vector<std::string> warnings() const;

 private:
  struct Tile;
  using WriteRows = std::function<void(Tile&, std::uint64_t row, std::uint64_t skip, std::uint64_t rows)>;
  void for_each_part(std::uint64_t rows, const WriteRows& write);
  void open_next();
  OutputPlace place_of_tile(InputCloud& cloud, const Format* format, std::uint64_t first) const;
  void complete();
  void finish_files(Tile& tile);
  void wait_for_first();
  void require_unchanged_inputs() const;

  TileRequest request_;
  ManyOutputs outputs_;
  FinishedTiles finished_;
  std::vector<std::uint64_t> first_row_;   ///< first row of each input, before any select
  std::uint64_t rows_opened_ = 0;          ///< rows of the cloud in the tiles before next_
  std::size_t next_ = 0;                   ///< tile to be opened next
  std::atomic<std::size_t> complete_ = 0;  ///< tiles; counted by background tasks, too
  std::unique_ptr<Tile> tile_;             ///< the tile that gets rows now
  std::uint64_t bytes_written_ = 0;
  OutputWarnings warnings_;
  std::vector<std::string> empty_;                ///< names of tiles without rows
  std::deque<std::unique_ptr<Tile>> completing_;  ///< last, so that their tasks end before the members that they use
};

}  // namespace pointsweep
