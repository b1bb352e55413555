// SPDX-License-Identifier: MIT
/// A run is a list of phases, each a function of values that earlier phases have returned. Checkpoints stand between
/// them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pointsweep/order/row_file.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/part/record_list.h"
#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/plan/output_layout.h"
#include "pointsweep/pipeline/rows/other_cloud.h"
#include "pointsweep/pipeline/rows/pass_update.h"
#include "pointsweep/pipeline/rows/pass_values.h"
#include "pointsweep/pipeline/run/context.h"
#include "pointsweep/storage/storage.h"
#include "pointsweep/sweep/sweep.h"

namespace pointsweep {

class DecodedInput;
class OutputFiles;

enum class PhaseKind : std::uint8_t {
  survey,  ///< looks at the input and plans the memory; then the outputs are opened
  order,   ///< puts the points in order
  sweep,   ///< takes the points in their order through the stages
  update,  ///< makes of the results the rows and values that the next pass begins with
  write,   ///< makes of the results, or of the rows, the output
};

struct Phase {
  PhaseKind kind;
  /// For which pass; the number of passes for the output that is put in order, or written, after the last one.
  std::size_t pass = 0;
  friend bool operator==(const Phase&, const Phase&) = default;
};

/// Returns the phases of a run. A plan without passes only puts the input in order.
std::vector<Phase> phases_of(const ChainPlan& plan);

/// The decisions about a run that need the survey of its input.
struct WorkPlan {
  std::optional<OutputLayout> layout;  ///< of the output's records; absent in a sort
  std::uint64_t budget;                ///< bytes
  RunMemory memory;
};

/// Points before they are put in order.
struct Surveyed {
  Survey survey;
  std::vector<RowBox> boxes;  ///< of the first pass that puts points in order, if it does so on demand
};

struct Ordered {
  Stream stream;
  std::vector<Vec3> bucket_places;  ///< between buckets of edges, if the pass connects points
  Survey survey;                    ///< of the cloud's points in that order, without its sample
  MemoryPlan memory;                ///< of the sweep
  std::uint64_t first_row = 0;      ///< row of `stream` that is the first row of the cloud, which may be a part
};

/// What the passes before leave to a pass, beside the selection of the cloud.
struct Rows {
  std::unique_ptr<RowFile> carried;  ///< null before the first pass
  CloudValues values;                ///< of the whole cloud, as far as they are known
  /// In a part, PassValues::save() of the last pass, in the place of the values that it makes.
  std::vector<std::vector<std::byte>> saved_values = {};
};

/// Decodes inputs that are decoded once, which `decoded` then holds. Refuses before that work what can be refused.
void decode_input(const Context& context, OutputFiles& files, std::optional<DecodedInput>& decoded);
/// Looks at the points of the input; at all of them where the plan asks for that.
Survey survey_input(const Context& context);
/// Plans the memory from the survey, and fills the boxes.
WorkPlan plan_work(const Context& context, Surveyed& input);
/// Looks at points before they are put in order. `exact`: at all of them.
Survey survey_points(const Context& context, const PointSource& source, bool exact);

/// Puts the points of a pass in order. If `p` is the number of passes, puts the records of the output in order, before
/// which it opens the files that are not open yet.
Ordered order_pass(const Context& context, const WorkPlan& work, std::size_t p, const Rows& rows, Surveyed points,
                   OutputFiles& files);

/// Puts the points of a pass that takes them in order into its order, in a part of a cloud. `numbered`: their working
/// records, at their positions (StreamOptions::numbered). `survey`: of the part. `first_row`: of its rows.
Ordered order_numbered(const Context& context, const WorkPlan& work, std::size_t p, const PointSource& numbered,
                       Survey survey, std::uint64_t first_row);

/// Returns a place for the results of pass `p`, with those that a checkpoint has kept.
std::unique_ptr<RowStore> results_of_pass(const Context& context, const WorkPlan& work, const MemoryPlan& memory,
                                          std::size_t p);

/// Where a task leaves what it knows of a tile.
struct PlaceOfTile {
  Storage* scratch = nullptr;  ///< null: the run has all points
  std::string name;            ///< of its objects
};

/// What a pass gets beside its points.
struct PassSupport {
  /// Gives the points of the other cloud that an in-order operator reads along an axis; empty if it reads none.
  std::function<void(int axis, const std::function<void(const OtherPoints&)>& take)> other = {};
  std::function<bool(Vec3 position, double distance)> may_lack = {};  ///< InOrderSetup::may_lack
  std::uint64_t* undecided = nullptr;  ///< gets the number of rows that are undecided, where points may be missing
  PlaceOfTile graph = {};              ///< for what a connecting stage of a part finds (part/tile_graph.h)
};

/// Makes the results of a pass from its points in order.
std::unique_ptr<RowStore> sweep_pass(const Context& context, const WorkPlan& work, std::size_t p,
                                     std::unique_ptr<Ordered> points, const CloudValues& values,
                                     const PassSupport& support);

/// The sweep of a pass in which one stage emits edges, and what the components of their graph tell of each point. Fills
/// `results` for all points that are in slabs. A sweep that is interrupted begins again.
SweepStatistics sweep_and_connect(const Context& context, const PlannedPass& pass, const Ordered& points,
                                  SweepOptions options, RowStore& results);
/// In a part of a cloud: leaves the graph of its tile, and fills `results` but for what the components tell.
SweepStatistics sweep_and_leave_graph(const Context& context, const PlannedPass& pass, const Ordered& points,
                                      SweepOptions options, const PlaceOfTile& graph, RowStore& results);
/// The results of a sweep that has left a graph, when the graphs of all tiles have been joined under the key `joined`.
struct LabelledTile {
  PlaceOfTile graph;
  std::string joined;
  RecordList& swept;  ///< results of the sweep, by row
};
/// Fills `results` with what the sweep has found and what the components tell of each point.
void label_points(const Context& context, const PlannedPass& pass, const MemoryPlan& memory, const LabelledTile& tile,
                  RowStore& results);

/// Ends a pass: its results become the rows that the next pass begins with. The cloud then has those rows alone.
/// `results` is null for a pass over rows, which makes them now.
Rows update_pass(const Context& context, const WorkPlan& work, std::size_t p, Rows before,
                 std::unique_ptr<RowStore> results);

/// Writes the output, in this order: the records of `ordered` if it is there; the rows, where all passes are over or no
/// row is left; else the results of pass `p`, as update_pass() takes them.
void write_output(const Context& context, const WorkPlan& work, std::size_t p, const Rows& rows, const Ordered* ordered,
                  RowStore* results, OutputFiles& files);

/// Gives the results of pass `p` by row, in the order of the rows. The arguments must outlive the function.
MadeRows made_by_pass(const Context& context, std::size_t p, const Rows& before, RowStore* results);
/// Returns how the rows that came into pass `p` become the rows that it leaves.
RowUpdate update_after(const ChainPlan& plan, std::size_t p);
/// Returns the cloud as pass `p` sees it. `before` must outlive the source.
PointSource source_of_pass(const Context& context, std::size_t p, const Rows& before);

}  // namespace pointsweep
