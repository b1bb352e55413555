// SPDX-License-Identifier: MIT
/// The plan of a chain: its graph, cut into passes over the cloud. A pass ends where a later stage needs a fact that
/// only its end tells: the neighbours of moved points, neighbours among the kept rows, or a value of the whole cloud
/// (docs/adr/0006, docs/adr/0009). The run, the dry run, the memory plan, the identity of a resumable run, the
/// reference engine and `verify` read this one plan.
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
  std::size_t number;  ///< number in the whole chain
};

/// A column of the window: one version of an attribute.
struct ColumnPlan {
  std::string attribute;
  std::string made_by;  ///< "the file", "a pass before", or the stage as "2 normals"
  std::uint32_t bytes = 0;
  std::size_t last_step = 0;  ///< the last step that reads it; a kept column is written after the last step
  bool written = false;
};

/// One pass. It sees the cloud as a file in which attributes made by earlier passes replace those of the input.
struct PlannedPass {
  PassKind kind = PassKind::sweep;
  std::vector<std::size_t> nodes;  ///< node of each stage of `plan`
  /// The stages. A select makes selection_attribute() besides the kept attributes.
  SweepPlan plan;
  std::vector<ColumnPlan> columns;  ///< by number of column
  /// For each of plan.file_columns, its fields of `input`.
  std::vector<std::vector<std::string>> file_fields;
  /// The last version of every attribute made and kept, in the order first made, which is the order in result records.
  std::vector<Attribute> made;
  /// The fields of that file: first the fields of the input's record, then the values carried from the pass before.
  Schema input;
  /// The attributes that the rows have after the pass, made by this or an earlier pass: those that later passes read,
  /// and those that are kept.
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
  /// Returns the stage that emits edges; null if there is none. Its attributes are known when the sweep has ended.
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
  Chain chain;  ///< the chain of the request
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
  /// Returns whether the rows stay what they are, in their order: the chain has no stages, or only drops attributes.
  bool only_copies() const;
  /// Returns whether the output can be opened only after all passes.
  bool opens_late() const { return selects() || graph.moved_bounds.has_value(); }
  /// Returns whether the results of pass `p` become the rows of another pass or of the reordering, not the output.
  bool leaves_rows(std::size_t p) const;
  /// Returns the most bytes that a point takes at once: while a pass ends, its carried bytes before and after the pass.
  std::uint64_t most_carried_bytes() const;
};

/// Plans a chain. Throws the errors of resolve(), and UsageError if an attribute to keep is unknown, or if nothing is
/// made and all rows are kept. The number of passes is minimal: stages run in the first pass in which all attributes
/// that they read exist, and passes without needed results are omitted.
/// A plan whose graph reads the rows of the inputs is for a cloud with InputCloud::number_rows().
ChainPlan plan_chain(const Chain& chain, const Schema& input, OutputNeeds needs = {});

}  // namespace pointsweep
