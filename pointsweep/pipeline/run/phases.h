// SPDX-License-Identifier: MIT
/// The phases of a run. Each is a function of values that earlier phases have returned. A run that can be resumed
/// stores a checkpoint after each order, sweep and update phase, except after the order phase that follows the last
/// pass.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pointsweep/order/row_store.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/part/record_list.h"
#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/plan/output_layout.h"
#include "pointsweep/pipeline/rows/other_cloud.h"
#include "pointsweep/pipeline/rows/pass_update.h"
#include "pointsweep/pipeline/run/context.h"
#include "pointsweep/storage/storage.h"
#include "pointsweep/sweep/sweep.h"

namespace pointsweep {

class OutputFiles;

enum class PhaseKind : std::uint8_t {
  survey,  ///< surveys the input and plans the memory; then the outputs are opened
  order,   ///< puts the points in order
  sweep,   ///< takes the points in order through the stages
  update,  ///< turns results into the rows and values with which the next pass begins
  write,   ///< writes the output from results or rows
};

struct Phase {
  PhaseKind kind;
  /// Number of the pass. The number of passes stands for the output after the last pass, which is put in order or
  /// written.
  std::size_t pass = 0;
  friend bool operator==(const Phase&, const Phase&) = default;
};

/// Returns the phases of a run. A plan without passes only puts the input in order.
std::vector<Phase> phases_of(const ChainPlan& plan);

/// The decisions about a run that need the survey of its input.
struct WorkPlan {
  std::optional<OutputLayout> layout;  ///< layout of the output's records; absent in a sort
  std::uint64_t budget;                ///< memory budget of the run in bytes
  RunMemory memory;

  /// Returns the bytes of the budget that the run is not expected to need.
  std::uint64_t spare_bytes() const { return budget - std::min(budget, memory.expected_bytes); }
};

/// The survey of the points that the next order phase puts in order.
struct Surveyed {
  Survey survey;
  std::vector<RowBox> boxes;  ///< boxes for slabs on demand, for the first pass that puts points in order
};

/// The result of an order phase.
struct Ordered {
  Stream stream;
  std::vector<Vec3> bucket_places;  ///< positions where buckets of edges begin (bucket_begins()); may be empty
  Survey survey;                    ///< survey of the positions of the points, without its sample
  MemoryPlan memory;                ///< plan for the sweep
  std::uint64_t first_row = 0;      ///< row of `stream` that is row 0 of Context::cloud, which may be one tile
};

/// Values that earlier passes leave to a pass.
struct Rows {
  std::shared_ptr<InputCloud> cloud = {};  ///< the rows of the input that no pass has dropped
  std::unique_ptr<RowFile> carried = {};   ///< records carried from the last pass; null before the first pass
  CloudValues values = {};                 ///< known values of the whole cloud
  /// Result of PassValues::save() for the last pass, from which join_values() makes values of the whole cloud. Empty in
  /// a run over all points.
  std::vector<std::vector<std::byte>> saved_values = {};
};

/// Returns the cloud, with a file of decoded records in place of inputs that are slow to decode
/// (FileInfo::decode_once), unless the run only copies rows. Before decoding, throws if the outputs cannot be written,
/// as far as this is known; an Outputs::writer is not checked.
InputCloud decode_input(const Context& context, OutputFiles& files);
/// Surveys a sample of the input, or all points if the order, the engine or the output needs it. A resumed run gets the
/// survey of its checkpoint; a run that only copies rows gets an empty survey.
Survey survey_input(const Context& context);
/// Plans the layout of the output and the memory from the survey, and sets the boxes of `input`.
WorkPlan plan_work(const Context& context, Surveyed& input);
/// Surveys points that are not in order yet. `exact`: true to read all points instead of a sample.
Survey survey_points(const Context& context, const PointSource& source, bool exact);

/// Puts the points of a pass in order. If `p` is the number of passes, puts the records of the output in order, and
/// first opens files that are not open yet. `points`: used for pass 0, in a sort, and if a checkpoint has the points in
/// order; in other cases this function surveys the points itself.
Ordered order_pass(const Context& context, const WorkPlan& work, std::size_t p, const Rows& rows, Surveyed points,
                   OutputFiles& files);

/// Puts the points of an in-order pass in order, in a task over one tile (part_run.h). `numbered`: working records with
/// the positions of the points, not yet their places, and with their rows (StreamOptions::numbered). `survey`: survey
/// of the tile. `first_row`: first row of the tile.
Ordered order_numbered(const Context& context, const WorkPlan& work, std::size_t p, const PointSource& numbered,
                       Survey survey, std::uint64_t first_row);

/// Returns a store for the results of pass `p`. In a resumed run, it holds the results that an earlier process has
/// saved.
std::unique_ptr<RowStore> results_of_pass(const Context& context, const WorkPlan& work, const MemoryPlan& memory,
                                          std::size_t p);

/// The place in the scratch, the storage that all tasks share (part_run.h), where a task stores the graph of a tile.
struct PlaceOfTile {
  Storage* scratch = nullptr;  ///< null in a run over all points
  std::string name;            ///< beginning of the names of the graph's objects
};

/// The other cloud of a pass, and what a pass over one tile needs besides its points.
struct PassSupport {
  /// Passes the points of the other cloud, in order along an axis, to `take`. Unused without another cloud.
  std::function<void(int axis, const std::function<void(const OtherPoints&)>& take)> other = {};
  std::function<bool(Vec3 position, double distance)> may_lack = {};  ///< value of InOrderSetup::may_lack
  /// Receives the number of rows that an in-order operator could not decide, because points of other tiles may be
  /// missing; null in a run over all points.
  std::uint64_t* undecided = nullptr;
  PlaceOfTile graph = {};  ///< place for the graph that a connecting stage makes of a tile (part/tile_graph.h)
};

/// Returns the results of pass `p`, made from its points in order.
std::unique_ptr<RowStore> sweep_pass(const Context& context, const WorkPlan& work, std::size_t p,
                                     std::unique_ptr<Ordered> points, const CloudValues& values,
                                     const PassSupport& support);

/// Performs a pass in which one stage makes edges between points. Also computes, for each point, the values of its
/// component of the graph. Fills `results` for all points with finite coordinates, which are in slabs; the caller fills
/// the records of other rows afterwards. A resumed run starts this sweep again.
SweepStatistics sweep_and_connect(const Context& context, const PlannedPass& pass, const Ordered& points,
                                  SweepOptions options, RowStore& results);
/// Performs a pass with a connecting stage in a task over one tile: stores the graph of the tile, and fills `results`
/// except for the values of components.
SweepStatistics sweep_and_leave_graph(const Context& context, const PlannedPass& pass, const Ordered& points,
                                      SweepOptions options, const PlaceOfTile& graph, RowStore& results);
/// The results of a sweep that has stored a graph. The graphs of all tiles are joined under the key `joined`.
struct LabelledTile {
  PlaceOfTile graph;
  std::string joined;
  RecordList& swept;  ///< results of the sweep, one record for each row
};
/// Fills `results` with the results of the sweep and the values of each point's component.
void label_points(const Context& context, const PlannedPass& pass, const MemoryPlan& memory, const LabelledTile& tile,
                  RowStore& results);

/// Ends a pass: its results become the rows with which the next pass begins. `results` is null for a pass over rows,
/// which is performed here.
Rows update_pass(const Context& context, const WorkPlan& work, std::size_t p, Rows before,
                 std::unique_ptr<RowStore> results);

/// Writes the output: the records of `ordered` if it is not null; `rows` if all passes are over or no row is left;
/// otherwise the results of pass `p`. `results` is null for a pass over rows, which is performed here.
void write_output(const Context& context, const WorkPlan& work, std::size_t p, const Rows& rows, const Ordered* ordered,
                  RowStore* results, OutputFiles& files);

/// Returns a function that passes on the results of pass `p` in the order of rows. The arguments must outlive it.
MadeRows made_by_pass(const Context& context, std::size_t p, const Rows& before, RowStore* results);
/// Returns the update that converts the rows before pass `p` to the rows after the pass.
RowUpdate update_after(const ChainPlan& plan, std::size_t p);
/// Returns the points of the cloud with the attributes that they have before pass `p`. `before` must outlive the
/// source.
PointSource source_of_pass(const Context& context, std::size_t p, const Rows& before);

}  // namespace pointsweep
