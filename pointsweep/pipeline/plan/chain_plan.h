// SPDX-License-Identifier: MIT
/// The one plan of a chain: its graph, cut into passes over the cloud. A pass ends where a later stage needs what only
/// its end can tell: the neighbours of moved points, neighbours among the rows that were kept, or a value of the whole
/// cloud (docs/adr/0006, docs/adr/0009). The run, the dry run, the memory plan, the identity of a resumable run, the
/// reference engine and `verify` read it.
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
#include "pointsweep/pipeline/plan/pass_schedule.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

/// A value of the cloud that is known when a pass has ended, of the rows it leaves.
struct PlannedValue {
  std::shared_ptr<const Reduction> reduction;
  std::size_t number;  ///< among those of the whole chain
};

/// A column of the window: one version of an attribute.
struct ColumnPlan {
  std::string attribute;
  std::string made_by;  ///< "the file", "a pass before", or the stage as "2 normals"
  std::uint32_t bytes = 0;
  std::size_t last_step = 0;  ///< the last step that reads it; a kept one is written after the last
  bool written = false;
};

/// One pass. To it the cloud is a file with what earlier passes made in the place of what the input has.
struct PlannedPass {
  PassKind kind = PassKind::sweep;
  std::vector<std::size_t> nodes;  ///< of the graph, by stage of `plan`
  /// Its stages; a select makes selection_attribute() beside what is kept.
  SweepPlan plan;
  std::vector<ColumnPlan> columns;  ///< by column number
  /// For each of plan.file_columns, the fields of `input` it is made of.
  std::vector<std::vector<std::string>> file_fields;
  /// The last version of every attribute made and kept, in the order first made; result records hold them one after
  /// another.
  std::vector<Attribute> made;
  /// The fields of that file: first the fields of the input's record, then the values carried from the pass before.
  Schema input;
  /// The attributes that the rows hold after the pass, made by this or an earlier pass: attributes that later passes
  /// read, and attributes that are kept.
  std::vector<Attribute> carried;
  bool selects = false;  ///< the pass leaves out some of the rows that it reads
  std::vector<PlannedValue> values;
  /// The numbers of the values that each stage is to be given, by stage.
  std::vector<std::vector<std::size_t>> values_of_stages;

  /// The operator of a pass of kind order; null for another pass.
  const InOrderOperator* in_order() const;
  /// Returns whether the points are put in order by InOrderOperator::place_of() their positions.
  bool has_places() const;
  /// The result record of a row that the pass says nothing about.
  std::vector<std::byte> fill_record() const;
  /// The stage that emits edges; null if there is none. What it makes is known when the sweep has ended.
  const Stage* connecting_stage() const;
  /// Indices of the fields of `input` that must travel with the points.
  std::vector<std::size_t> payload() const;
  /// Turns the names into fields of the working record.
  void bind(const Schema& working_record);
  /// Returns the bytes of the working record of a point in the stream, without its row.
  std::uint64_t travelling_bytes() const;
  /// Returns the bytes of a point between this pass and the next.
  std::uint64_t carried_bytes() const;
};

struct ChainPlan {
  Chain chain;  ///< as it was asked for
  ChainGraph graph;
  std::vector<PlannedPass> passes;  ///< at least one
  /// The last version of every attribute made and kept, in the order first made.
  std::vector<Attribute> made;
  /// The fields of made attributes and of the input that are written.
  KeptFields kept;
  /// True if Order::sweep asks for an order that differs from the order of the (only) sweep.
  bool reorders = false;
  /// True if that order is by stream_position_attribute(), the last attribute that the last pass carries. False if it
  /// is by the positions of the input.
  bool by_moved_positions = false;

  bool selects() const { return graph.drops_rows(); }
  /// Returns whether the output can be opened only after all passes.
  bool opens_late() const { return selects() || graph.moved_bounds.has_value(); }
  /// Returns whether the results of pass `p` become the rows of another pass or of the reordering, not the output.
  bool leaves_rows(std::size_t p) const;
  /// Returns the most bytes that a point takes at once: while a pass ends, its carried bytes before and after the pass.
  std::uint64_t most_carried_bytes() const;
};

/// Resolves the chain. Throws as resolve(), and UsageError when an attribute to keep is neither made nor the input's,
/// and where nothing is made and all rows are kept. As few passes as the chain allows: stages run in the first pass in
/// which all they read is there, and a pass without results that are used is left out.
/// A plan whose graph reads the rows of the inputs is for a cloud with InputCloud::number_rows().
ChainPlan plan_chain(const Chain& chain, const Schema& input, OutputNeeds needs = {});

}  // namespace pointsweep
