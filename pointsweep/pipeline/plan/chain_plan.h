// SPDX-License-Identifier: MIT
/// The plan of a chain: its graph, cut into passes over the cloud. A pass ends where a later stage needs a fact that is
/// known only when the pass has ended: the neighbours of moved points, the rows that a select has kept, an attribute of
/// a stage that connects points or orders them, or a value of the whole cloud (docs/adr/0006, docs/adr/0009). The run,
/// the dry run, the memory plan, the identity of a resumable run, the reference engine and `verify` read this one plan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operator.h"
#include "pointsweep/pipeline/plan/chain_graph.h"
#include "pointsweep/pipeline/plan/kept_fields.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

/// A value that is reduced from the rows that a pass leaves. It is known when the pass has ended.
struct PlannedValue {
  std::shared_ptr<const Reduction> reduction;
  std::size_t number;  ///< index of the reduce node in ChainGraph::nodes
};

/// A column: the values of one version of an attribute that a pass holds for points in memory.
struct ColumnPlan {
  std::string attribute;
  std::string made_by;  ///< "the file", "a pass before", or number and name of a stage: "2 normals"
  std::uint32_t bytes = 0;
  std::size_t last_step = 0;  ///< the last step that makes or reads the column; the last step of the pass if `written`
  bool written = false;
};

enum class PassKind : std::uint8_t {
  sweep,  ///< finds neighbourhoods
  rows,   ///< reads the rows in order; its stages read only the point itself
  order,  ///< puts the points in order for an InOrderOperator, by position, or by the place that the operator gives
          ///< each (Places)
};

/// One pass. A pass sees the cloud as a file in which attributes made by earlier passes replace attributes of the input
/// or are added.
struct PlannedPass {
  PassKind kind = PassKind::sweep;
  std::vector<std::size_t> nodes;  ///< graph node of each stage of `plan`
  /// The stages, steps and columns. The result records of a pass that selects also contain selection_attribute().
  SweepPlan plan;
  std::vector<ColumnPlan> columns;  ///< the columns of `plan`, by number
  /// For each of plan.file_columns, the names of the fields of `input` that fill the column.
  std::vector<std::vector<std::string>> file_fields;
  /// The last version of every attribute that the pass makes and keeps, in the order of result records.
  std::vector<Attribute> made;
  /// The fields of the cloud as the pass sees it: first the fields of the input's record, then the carried values.
  Schema input;
  /// The attributes that the rows have after the pass, made by this pass or an earlier one: those that later passes
  /// read, and those that are written.
  std::vector<Attribute> carried;
  bool selects = false;  ///< the pass leaves out some of the rows that it reads
  std::vector<PlannedValue> values;
  /// For each stage, the numbers of the values that it needs (PlannedValue::number).
  std::vector<std::vector<std::size_t>> values_of_stages;

  /// Returns the operator of a pass of the kind PassKind::order; null for other passes.
  const InOrderOperator* in_order() const;
  /// Returns whether the points are ordered by places that the operator gives them (Places), not by their positions.
  bool has_places() const;
  /// Returns the result record of a row for which the pass makes no values. It consists of the fill bytes of the
  /// attributes (Attribute::fill).
  std::vector<std::byte> fill_record() const;
  /// Returns the stage that emits edges; null if there is none. Its attributes are known when the sweep has ended.
  const Stage* connecting_stage() const;
  /// Returns the indices of the fields of `input` that the working records of the pass must contain besides the
  /// coordinates.
  std::vector<std::size_t> payload() const;
  /// Sets plan.file_columns: replaces the names in `file_fields` by indices of fields of `working_record`.
  void bind(const Schema& working_record);
  /// Estimates the bytes of the working record of a point in the stream, without its row number. Counts 8 bytes for
  /// each value of the fields of payload().
  std::uint64_t travelling_bytes() const;
  /// Returns the bytes of a point's carried attributes between this pass and the next.
  std::uint64_t carried_bytes() const;
};

struct ChainPlan {
  Chain chain;  ///< the requested chain, with the k and radius of every neighbourhood
  ChainGraph graph;
  std::vector<PlannedPass> passes;  ///< none in a run that only sorts; else at least one
  /// The last version of every attribute made and kept, in the order first made.
  std::vector<Attribute> made;
  /// The fields of made attributes and of the input that are written. KeptFields::attributes is empty if Chain::keep is
  /// empty and no stage drops attributes; then all are written.
  KeptFields kept;
  /// True if a last phase puts the output in the order of the sweep, because no pass leaves the results in that order.
  bool reorders = false;
  /// True if the output is ordered by stream_position_attribute(), the last attribute that the last pass carries; false
  /// if it is ordered by the positions of the input, or by input rows.
  bool by_moved_positions = false;

  bool selects() const { return graph.drops_rows(); }
  /// Returns whether the run only copies rows in their order: the chain has no stages, or only drops attributes.
  bool only_copies() const;
  /// Returns whether the output can be opened only after all passes.
  bool opens_late() const { return selects() || graph.moved_bounds.has_value(); }
  /// Returns whether the rows after pass `p` must be complete before anything is written: if another pass or the
  /// reordering follows, if this pass drops rows or makes nothing, or if the output needs the bounds of moved points.
  /// The results of other passes are written directly.
  bool leaves_rows(std::size_t p) const;
  /// Returns the most bytes of carried attributes that a point has at once: at the end of a pass, the bytes carried
  /// into the pass and the bytes carried out of it.
  std::uint64_t most_carried_bytes() const;
};

/// Plans a chain. Throws the errors of with_named_neighborhoods() and resolve(), and UsageError if an attribute to keep
/// is unknown, or if the chain has stages but makes, drops and selects nothing. To keep the number of passes small,
/// stages run in the first pass in which all attributes that they read exist, and passes without needed results are
/// omitted. If the graph reads row numbers (reads_input_rows()), the run needs a cloud with row numbers:
/// InputCloud::numbered().
ChainPlan plan_chain(const Chain& chain, const Schema& input, OutputNeeds needs = {});

}  // namespace pointsweep
