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
  /// Canonical order along the axis of the sweep: by the coordinate on the axis, ties by x, y, z, then row; non-finite
  /// points last, by row. The order uses the coordinates of the input, or the coordinates at the last Resort of the
  /// chain.
  sweep,
};

/// The engine, which finds the neighbourhoods and applies the operators. The library itself has only `exact`.
enum class Engine : std::uint8_t {
  exact,  ///< the engine of this library: exact, in parallel, within the memory budget
  /// The paper's own algorithm, point by point, on one thread. Neighbourhoods may lack points; Statistics::reference
  /// counts such neighbourhoods. The run throws Error if the active set outgrows the memory budget.
  reference,
};

/// The treatment of points whose coordinates are NaN or infinite. Such points are never neighbours of other points.
enum class Nonfinite : std::uint8_t {
  by_format,  ///< `drop` if an output has a format that cannot hold such points (LAS), else `keep`
  keep,       ///< such points are written, with made attributes as documented for undefined results
  drop,       ///< such points are dropped from all outputs; row numbers (Order::input, neighbours) do not count them
  refuse,     ///< the first such point ends the run with an Error
};

struct Progress {
  /// Name of the phase: "checking" (for nonfinite points), "decoding", "ordering", "sweeping", "updating" (from one
  /// sweep to the next), "writing" or "completing" (of an output that is divided among files, and of COPC).
  const char* phase;
  std::uint64_t done;    ///< number of points that have passed the phase
  std::uint64_t total;   ///< number of all points
  std::uint64_t active;  ///< number of points in the window while sweeping; 0 in other phases
};

/// Observes a run, and can stop it. An exception thrown by an override ends the run, which then leaves no files.
///
/// cancel(), from any thread or from a signal handler, ends the run with Cancelled within a fraction of a second. A
/// call of an operator is not interrupted, but gets at most 262,144 neighbours, or one point. A cancelled observer
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
  std::uint64_t memory_bytes = 0;  ///< memory budget of the whole process in bytes; 0 for half of the available memory
  unsigned threads = 0;            ///< most threads; 0 for one thread per core. A small budget may allow fewer threads
  /// Folder for data that do not fit in the budget. Must exist and be writable, even if nothing is spilled; empty for
  /// the temporary folder of the system.
  std::filesystem::path temp_folder = {};
};

/// The division of the points of an output among several point files: by square tiles in x and y, or by the values of
/// an attribute. Each point belongs to exactly one file (buffers of tiles repeat points), and points keep their order.
/// All files have the same layout, grid and header, except for counts and bounds. Files without points are not written.
struct OutputDivision {
  /// Length of the edge of a tile, above 0; absent to make no tiles. Tile (i, j) holds the points with l(i) <= x <
  /// l(i + 1), where l(i) = tile_origin[0] + i * tile in float64 and x is the coordinate that a reader of the output
  /// gets, and y likewise. The name of a file is `X_Y`, the lower corner of its tile. Points whose x or y is not finite
  /// are in the file `unplaced`.
  std::optional<double> tile = {};
  std::array<double, 2> tile_origin = {0, 0};  ///< x and y of a corner of tiles
  /// Width of a buffer around each tile, from 0 to `tile`. The file of a tile also contains the points of the eight
  /// adjacent tiles that are less than this width outside of the tile in x and in y; on its lower sides, at most this
  /// width. All points get the attribute `buffer`, which is 1 for points of buffers.
  double tile_buffer = 0;
  /// Name of an attribute of the output, of whole numbers, whose values divide the points; empty to divide by none. The
  /// name of a file is `ATTRIBUTE_VALUE`.
  std::string split = {};

  /// Returns whether the output is divided among files.
  bool divides() const { return tile.has_value() || !split.empty(); }
  friend bool operator==(const OutputDivision&, const OutputDivision&) = default;
};

/// Options of a run: first `overwrite` and the options that the results depend on; from `resources` on, options without
/// effect on the results.
struct RunOptions {
  Order order = Order::input;
  std::optional<int> axis = {};  ///< axis of the sweep, 0, 1 or 2; absent for the longest
  Engine engine = Engine::exact;
  Nonfinite nonfinite = Nonfinite::by_format;
  bool overwrite = false;  ///< true if outputs may replace existing files
  /// Type of x, y and z in the output, Type::f64 or Type::f32; absent for the type of the input, or Type::f64 if the
  /// chain moves points. Positions are rounded to this type, while normals and other results belong to the positions
  /// before rounding. The run throws UsageError for LAS, which stores integers.
  std::optional<Type> positions = {};
  FileLayout layout = {};  ///< layout of the point files
  /// Division of Outputs::points, whose path must have a * for the names of the files. More than 10,000 files are an
  /// error before the first file is written, unless `overwrite`. Cannot be combined with resume_folder.
  OutputDivision division = {};
  /// Attributes of the input that made attributes may overwrite although their meanings may differ, such as
  /// `curvature`, which programs define differently. Attributes with exactly the name of a made one (nx, ny, nz) are
  /// always overwritten.
  std::vector<std::string> replace = {};
  std::string prefix = {};  ///< prefix of the names of made attributes in outputs, except positions
  /// True if outputs get a record of this run: its operators with their options, and the inputs. Records that the
  /// inputs contain are always kept.
  bool provenance = true;
  bool input_paths = false;  ///< true if the record has the absolute paths of the inputs instead of their file names

  Resources resources = {};
  /// A folder for checkpoints, used instead of the temporary folder; empty for a run without checkpoints. If the
  /// process ends before the run is complete, the same run with the same folder continues from the last checkpoint. The
  /// folder of another run is an error. The folder is removed when the run is complete. All intermediate data go to
  /// files. Needs inputs that are files, and Engine::exact.
  std::filesystem::path resume_folder = {};
  /// Seconds between two checkpoints inside a phase; more if a checkpoint takes longer than a hundredth of this time.
  /// 0: a checkpoint after every slab.
  double checkpoint_seconds = 30;
  bool count_distances = false;  ///< true to fill Statistics::neighbor_distances; about 5 ns a point
  /// A .npy file of one uint8 for each input row, for pictures of the sweep: the state of the point when half of the
  /// points have been read. 0: it is unread; 1: it is in the window and waits for unread points; 2: its neighbours are
  /// known, and it waits for their values; 3: it is finished or deferred, but other points still need it; 4: it has
  /// left the window. Takes a byte of memory for each point in addition to the budget; not with resume_folder. Empty:
  /// no file.
  std::filesystem::path half_way_states = {};
  Observer* observer = nullptr;  ///< borrowed observer of the run; null for none
};

/// Destinations of the results: any of `points`, `arrays` and `writer`, e.g. {.points = "out.ply"}, or `tiles` alone. A
/// run without a destination is refused.
struct Outputs {
  /// Point file with the attributes of the input and the made attributes; its extension decides its format. With
  /// RunOptions::division, the point files, e.g. out/*.laz, where * stands for their names; missing folders are made.
  std::filesystem::path points = {};
  /// Names of made attributes, and the .npy file for each. Needs Order::input.
  std::vector<std::pair<std::string, std::filesystem::path>> arrays = {};
  /// Function that makes a writer for the records that `points` would get: an ArrayWriter, or a writer of your own.
  std::function<std::unique_ptr<Writer>(const OutputPlan&)> writer = {};
  /// A point file for each input of the cloud, in the order of the inputs, instead of `points`, `arrays` and `writer`.
  /// Each file has the rows, attributes, types, header and grid of its input, and the attributes made from the whole
  /// cloud. Each file is complete or absent. Needs Order::input. Missing folders are made.
  std::vector<std::filesystem::path> tiles = {};
};

/// Runs `chain` over `cloud`. Either all outputs are complete, or an exception is thrown and no output is left, except
/// tiles that were complete before and bytes on standard output. The bytes of the outputs depend only on the points,
/// the chain and the options before RunOptions::resources. Throws UsageError for a chain that does not fit the cloud
/// and for an output that is an input or another output, by whatever path; Error for failures of files, memory and
/// disk, and, before the work, for a budget that is too small; Cancelled after Observer::cancel().
POINTSWEEP_EXPORT Statistics run(Cloud& cloud, const Chain& chain, const Outputs& outputs,
                                 const RunOptions& options = {});

/// Writes the cloud in canonical order along the axis of `options`, with the attributes that `keep` names (like
/// Chain::keep), or all attributes if it is empty, unchanged. Throws the errors of run().
POINTSWEEP_EXPORT Statistics sort(Cloud& cloud, const std::filesystem::path& output, const RunOptions& options = {},
                                  const std::vector<std::string>& keep = {});

/// Describes a run() in lines for people: passes, stages with their buffers, columns, slabs and memory. Reads a sample
/// of the cloud and writes nothing. Throws the errors that run() throws before the work. `outputs`: their formats
/// decide names and the size of records; the files need not exist.
POINTSWEEP_EXPORT std::string plan_text(Cloud& cloud, const Chain& chain, const Outputs& outputs = {},
                                        const RunOptions& options = {});
/// Describes a sort() in lines for people, like plan_text(): points, order, slabs, records and memory.
POINTSWEEP_EXPORT std::string sort_plan_text(Cloud& cloud, const std::filesystem::path& output,
                                             const RunOptions& options = {}, const std::vector<std::string>& keep = {});

}  // namespace pointsweep
