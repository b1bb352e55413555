// SPDX-License-Identifier: MIT
/// The one plan of a chain: its graph, cut into passes over the cloud. A pass ends where a later stage needs what only
/// its end can tell: the neighbours of moved points, neighbours among the rows that were kept, or a value of the whole
/// cloud (docs/adr/0006, docs/adr/0009). The run, the dry run, the memory plan, the identity of a resumable run, the
/// reference engine and `verify` read it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
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
  /// The fields of that file: those of the input's record, behind which the values carried from the pass before follow.
  Schema input;
  /// What the rows hold when it has ended, whichever pass made it: what later passes read and what is kept.
  std::vector<Attribute> carried;
  bool selects = false;  ///< of the rows it reads, it leaves some out
  std::vector<PlannedValue> values;
  /// By stage, the numbers of the values it is to be given.
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
  /// What the working record of a point takes in the stream, without its row.
  std::uint64_t travelling_bytes() const;
  /// What a point takes between this pass and the next.
  std::uint64_t carried_bytes() const;
};

struct ChainPlan {
  Chain chain;  ///< as it was asked for
  ChainGraph graph;
  std::vector<PlannedPass> passes;  ///< at least one
  /// The last version of every attribute made and kept, in the order first made.
  std::vector<Attribute> made;
  /// What of these and of the input is written.
  KeptFields kept;
  /// Order::sweep asks for an order that is not the one of the (only) sweep.
  bool reorders = false;
  /// That order is the one of stream_position_attribute(), the last of what the last pass carries; otherwise the
  /// input's.
  bool by_moved_positions = false;

  bool selects() const { return graph.drops_rows(); }
  /// Returns whether the output can be opened only after all passes.
  bool opens_late() const { return selects() || graph.moved_bounds.has_value(); }
  /// Whether what pass `p` makes becomes the rows of another pass, or of the reordering, and not the output at once.
  bool leaves_rows(std::size_t p) const;
  /// Of a point, the most at once: while a pass ends, what came into it and what goes out of it.
  std::uint64_t most_carried_bytes() const;
};

/// Resolves the chain. Throws as resolve(), and UsageError when an attribute to keep is neither made nor the input's,
/// and where nothing is made and all rows are kept. As few passes as the chain allows: stages run in the first pass in
/// which all they read is there, and a pass without results that are used is left out.
ChainPlan plan_chain(const Chain& chain, const Schema& input, OutputNeeds needs = {});

}  // namespace pointsweep
