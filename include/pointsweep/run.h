// SPDX-License-Identifier: MIT
/// Running a chain of operators over a cloud of any size: the main function of the library.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/chain.h"
#include "pointsweep/cloud.h"
#include "pointsweep/error.h"
#include "pointsweep/export.h"
#include "pointsweep/statistics.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// The order of the output's rows. It never changes a value.
enum class Order : std::uint8_t {
  input,  ///< row i of the output is row i of the input
  sweep,  ///< canonical order along the sweep axis: coordinate on it, ties by x, y, z, row; not finite points last, by
          ///< row; at the positions of the input, or of the last Resort of the chain
};

/// The engine, which finds the neighbourhoods and applies the operators. The library itself has only `exact`.
enum class Engine : std::uint8_t {
  exact,      ///< the engine of this library: exact, in parallel, within the memory budget
  reference,  ///< the paper's own algorithm, point by point, on one thread: neighbourhoods may lack a point, and counts
              ///< of these are in Statistics::reference. Error if its active set outgrows the budget on the way.
};

/// The treatment of points whose coordinates are NaN or infinite. They are neighbours of no other point in any case.
enum class Nonfinite : std::uint8_t {
  by_format,  ///< `drop` for LAS, which cannot hold them, `keep` for all other formats
  keep,       ///< they are written; made attributes have the value that is documented for undefined results
  drop,       ///< their rows are dropped from all outputs; row numbers (Order::input, neighbours) do not count them
  refuse,     ///< the first one ends the run
};

struct Progress {
  const char* phase;   ///< "checking" (for nonfinite points), "decoding", "ordering", "sweeping", "updating" (from one
                       ///< sweep to the next), "writing" or "completing" (of an output that is divided among files)
  std::uint64_t done;  ///< points
  std::uint64_t total;
  std::uint64_t active;  ///< points in the window, while sweeping
};

/// Observes a run, and can stop it. An exception thrown by an override ends the run, which then leaves no files.
///
/// cancel(), from any thread or from a signal handler, ends the run with Cancelled within a fraction of a second. An
/// operator is not interrupted between two batches of at most 262,144 neighbours or one point. A cancelled observer
/// remains cancelled.
class POINTSWEEP_EXPORT Observer {
 public:
  virtual ~Observer();
  /// Called from one thread at a time, a few times a second at most on average.
  virtual void on_progress(const Progress& progress);
  /// Called with each sentence about the input, the request or the output that may have an unexpected result, as soon
  /// as the sentence is known.
  virtual void on_warning(const std::string& sentence);
  /// Called with each sentence about an automatic decision of the run: defaults in another unit, the continuation of an
  /// earlier process, and the estimate of a long run before it starts. Calls on_warning() unless overridden.
  /// Statistics::warnings has the sentences of both functions, except estimates.
  virtual void on_note(const std::string& sentence);

  void cancel() noexcept { own_.cancel(); }
  /// Returns the token by which the run is stopped: the observer's own token, or a token that several observers share.
  /// The token must outlive the run.
  virtual const CancellationToken& token() const noexcept;

 private:
  CancellationToken own_;
};

/// The resources of the machine that a run may take. No result depends on them.
struct Resources {
  std::uint64_t memory_bytes = 0;  ///< memory budget of the whole process; 0: half of the available memory
  unsigned threads = 0;            ///< most threads; 0: one for each core. Fewer are used if the budget is too small
  /// Folder for data that do not fit the budget. Must exist and be writable, even if nothing is spilled; empty: the
  /// folder of the system.
  std::filesystem::path temp_folder = {};
};

/// The division of the points of an output among several point files: by square tiles in x and y, or by the values of
/// an attribute. Each point is in exactly one file, and points keep their order. All files have the same layout, grid
/// and header, except for counts and bounds. Files without points are not written.
struct OutputDivision {
  /// Length of the edge of a tile, above 0; absent: no tiles. Tile (i, j) holds origin.x + i * tile <= x < origin.x +
  /// (i + 1) * tile, and y likewise, in float64, of the coordinates that a reader of the output gets. Its name is
  /// `X_Y`, its lower corner. Points whose x or y is not finite are in the file `unplaced`.
  std::optional<double> tile = {};
  std::array<double, 2> tile_origin = {0, 0};  ///< a corner of tiles
  /// Width of a buffer around each tile, from 0 to `tile`. A tile also contains the points of the eight adjacent tiles
  /// that are less than this outside of it in x and in y; on its lower sides, at most this. All points have the
  /// attribute `buffer`, which is 1 for these.
  double tile_buffer = 0;
  /// Name of an attribute of the output, of whole numbers. The name of a file is `ATTRIBUTE_VALUE`. Empty: none.
  std::string split = {};

  /// Returns whether there is more than one file.
  bool divides() const { return tile.has_value() || !split.empty(); }
  friend bool operator==(const OutputDivision&, const OutputDivision&) = default;
};

/// Options of a run: first the options that the results depend on, then its resources, then its observer.
struct RunOptions {
  Order order = Order::input;
  std::optional<int> axis = {};  ///< axis of the sweep: 0, 1, 2; absent: the longest
  Engine engine = Engine::exact;
  Nonfinite nonfinite = Nonfinite::by_format;
  bool overwrite = false;  ///< outputs may replace existing files
  /// Type of x, y and z in the output, Type::f64 or Type::f32. Positions are rounded to it, while normals and other
  /// results belong to the positions before rounding. Absent: the type of the input, or Type::f64 if the chain moves
  /// points. A UsageError for LAS, which stores integers.
  std::optional<Type> positions = {};
  FileLayout layout = {};  ///< layout of the point files
  /// Divides Outputs::points, whose path must have a * for the names of the files. More than 10,000 files are an error
  /// before the first is written, unless `overwrite`. Not with resume_folder.
  OutputDivision division = {};
  /// Attributes of the input that made attributes may overwrite although their meanings may differ, such as
  /// `curvature`, which programs define differently. Attributes with exactly the name of a made one (nx, ny, nz) are
  /// always overwritten.
  std::vector<std::string> replace = {};
  std::string prefix = {};  ///< before the names of made attributes in outputs, except positions
  /// Outputs contain a record of this run: its operators with their options, and the inputs. Records of the inputs are
  /// always kept.
  bool provenance = true;
  bool input_paths = false;  ///< the record has the absolute paths of the inputs instead of their file names

  Resources resources = {};
  /// A folder for checkpoints, used instead of the temporary folder. If the process ends before the run is complete,
  /// the same run with the same folder continues from the last checkpoint. The folder of another run is an error; it is
  /// removed when the run is complete. All intermediate data go to files. Needs inputs that are files, and
  /// Engine::exact. Empty: no checkpoints.
  std::filesystem::path resume_folder = {};
  Observer* observer = nullptr;  ///< borrowed; null: no observer
};

/// Destinations of the results: any of the first three, e.g. {.points = "out.ply"}, or tiles. A run without a
/// destination is refused.
struct Outputs {
  /// Point file with the attributes of the input and the made ones; its extension tells the format. With
  /// RunOptions::division: the point files, e.g. out/*.laz, where * stands for their names. Missing folders are made.
  std::filesystem::path points = {};
  /// Made attribute -> .npy file; needs Order::input.
  std::vector<std::pair<std::string, std::filesystem::path>> arrays = {};
  /// Makes a writer for the same records as `points` would get: an ArrayWriter, or one of your own.
  std::function<std::unique_ptr<Writer>(const OutputPlan&)> writer = {};
  /// Used instead of the members above: a point file for each input of the cloud, in their order. It has the input's
  /// rows, attributes, types, header and grid, and the attributes made from the whole cloud. Each file is complete or
  /// absent. Needs Order::input. Missing folders are made.
  std::vector<std::filesystem::path> tiles = {};
};

/// Runs `chain` over `cloud`: all outputs are complete, or there are none and an exception; tiles that were complete
/// before the exception remain. The bytes of the outputs depend on the points, the chain and the options above
/// `resources` alone. Throws UsageError for a chain that does not fit and for an output that is an input or another
/// output, by whatever path; Error for files, memory and disk, and for a budget that is too small, before the work
/// starts; Cancelled.
POINTSWEEP_EXPORT Statistics run(Cloud& cloud, const Chain& chain, const Outputs& outputs,
                                 const RunOptions& options = {});

/// Writes the cloud in canonical order along the axis: the attributes that `keep` names (as Chain::keep), unchanged, or
/// all of them if it is empty. Throws as run() does.
POINTSWEEP_EXPORT Statistics sort(Cloud& cloud, const std::filesystem::path& output, const RunOptions& options = {},
                                  const std::vector<std::string>& keep = {});

/// Describes a run() in lines for people: passes, stages with their buffers, columns, slabs and memory. Reads a sample
/// of the cloud and writes nothing. Throws the errors that run() throws before the work. `output`: the point file to
/// write, which need not exist.
POINTSWEEP_EXPORT std::string plan_text(Cloud& cloud, const Chain& chain, const std::filesystem::path& output = {},
                                        const RunOptions& options = {});

}  // namespace pointsweep
