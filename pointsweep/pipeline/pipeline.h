// SPDX-License-Identifier: MIT
/// Running a chain of operators over a cloud of any size: the library's front door.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/formats/cloud.h"
#include "pointsweep/formats/writer.h"
#include "pointsweep/pipeline/plan/chain.h"
#include "pointsweep/pipeline/statistics.h"

namespace pointsweep {

enum class Order : std::uint8_t {
  input,  ///< row i of the output is row i of the input
  sweep,  ///< canonical order along the sweep axis: coordinate on it, ties by x, y, z, row; not finite ones last, by
          ///< row. Of the input's positions, or of those at the last Resort of the chain
};

/// What finds the neighbourhoods and moves the points through the operators.
enum class Engine : std::uint8_t {
  exact,      ///< the engine of this library: exact, in parallel, within the memory budget
  reference,  ///< the paper's own algorithm, point by point, on one thread: neighbourhoods may lack a point, and counts
              ///< of these are in Statistics::reference. Error if its active set outgrows the budget on the way.
};

/// What happens to points whose coordinates are NaN or infinite. They are neighbours of no other point in any case.
enum class Nonfinite : std::uint8_t {
  by_format,  ///< `drop` for LAS, which cannot hold them, `keep` for all other formats
  keep,       ///< they are written with all their attributes, and what is made has the value of points that have none
  drop,       ///< their rows are left out of all outputs; numbers of rows (Order::input, neighbours) count the others
  refuse,     ///< the first one ends the run
};

struct Progress {
  const char* phase;   ///< "checking" (for nonfinite points), "decoding", "ordering", "sweeping", "updating" (from one
                       ///< sweep to the next) or "writing"
  std::uint64_t done;  ///< points
  std::uint64_t total;
  std::uint64_t active;  ///< points in the window, while sweeping
};

struct RunOptions {
  std::uint64_t memory_bytes = 0;     ///< budget; 0: half of what is available
  unsigned threads = 0;               ///< 0: one for each core
  std::filesystem::path temp_folder;  ///< must exist and be writable, even if nothing is spilled; empty: the system's
  std::optional<int> axis;            ///< 0, 1, 2; absent: the longest
  Order order = Order::input;
  Engine engine = Engine::exact;
  bool overwrite = false;
  /// Type that x, y and z of the output get if the chain moves points, whatever they are in the input: Type::f64, or
  /// Type::f32, to which moved positions are then rounded while normals and all else describe the unrounded ones.
  /// A LAS file keeps the integer grid of a LAS input.
  Type moved_positions = Type::f64;
  Nonfinite nonfinite = Nonfinite::by_format;
  /// Attributes of the input that made ones may overwrite, although they only bear one of their names
  /// (output_names.h).
  std::vector<std::string> replace = {};
  std::string prefix = {};  ///< before the names of made attributes in outputs, except positions
  /// Outputs hold a record of this run (formats/provenance.h): its operators with their options, and the inputs. The
  /// records of the inputs stay in any case.
  bool provenance = true;
  bool input_paths = false;  ///< that record holds the absolute paths of the inputs instead of their file names
  /// Called from one thread at a time, a few times a second at most on average; may throw to end the run, leaving
  /// nothing behind.
  std::function<void(const Progress&)> progress;
  /// Called before the sweeps with a sentence about them that the user should know while there is time to stop.
  std::function<void(const std::string&)> notice;
  /// Ends the run with Cancelled, within a fraction of a second, once another thread or a signal handler cancels it;
  /// nothing is left behind. An operator is not interrupted between two batches of at most 262,144 neighbours or one
  /// point. Must outlive the run. Null: that of the CancellationScope of the caller, if any.
  const CancellationToken* cancellation = nullptr;
  std::uint64_t slab_points = 0;     ///< aim; 0: chosen from the cloud. No result depends on it.
  std::uint32_t cell_points = 1024;  ///< a multiple of 16 up to 2,048. No result depends on it.
  bool count_distances = false;      ///< fill Statistics::neighbor_distances; about 5 ns a point
  /// A .npy file of one uint8 for each input row: its PointState (sweep/sweep.h) when half of the points have been
  /// read. Takes a byte of memory for each point in addition to the budget; empty: none.
  std::filesystem::path half_way_states;
  bool spill = false;  ///< use the temporary folder even where memory would do. No result depends on it.
  /// Find neighbourhoods again for every step even where there is memory to keep them. No result depends on it.
  bool search_again = false;
  /// For the lists of neighbours that a thread has in hand, at least those of one point; 0: chosen from the budget. No
  /// result depends on it.
  std::uint64_t lists_bytes = 0;
  /// A folder for checkpoints, in the place of temp_folder: if this process ends before the run is complete, the same
  /// run, given the same folder, goes on from the last one. Refused if another run is in it, removed when the run is
  /// complete. Everything is spilled. Neither with Engine::reference nor with half_way_states. Empty: none.
  std::filesystem::path resume_folder;
  /// Between two checkpoints, not counting those at the end of a phase; more where a checkpoint takes longer than a
  /// hundredth of it. 0: after every slab.
  double checkpoint_seconds = 30;
};

/// Where results go. Any of the three may be absent.
struct Outputs {
  std::filesystem::path points;  ///< point file with the input's attributes and the made ones
  std::vector<std::pair<std::string, std::filesystem::path>>
      arrays;  ///< made attribute -> .npy file; needs Order::input
  /// Makes a writer for the same records as `points` would get, e.g. an ArrayWriter.
  std::function<std::unique_ptr<Writer>(const OutputPlan&)> writer;
};

/// Runs `chain` over `cloud`. Complete outputs or none. Throws UsageError for a chain that does not fit and for an
/// output that is an input or another output, by whatever path; Error for files, memory and disk.
Statistics run(Cloud& cloud, const Chain& chain, const Outputs& outputs, const RunOptions& options = {});

/// The type of x, y and z in `output` of a chain that moves points; absent: that of the input.
std::optional<Type> type_of_moved_positions(const Schema& input, const std::filesystem::path& output,
                                            const RunOptions& options);

/// Writes the cloud in canonical order along the axis: the attributes that `keep` names (kept_fields.h), unchanged, or
/// all of them if it is empty.
Statistics sort(Cloud& cloud, const std::filesystem::path& output, const RunOptions& options = {},
                const std::vector<std::string>& keep = {});

}  // namespace pointsweep
