// SPDX-License-Identifier: MIT
/// A chain of operators, checked against the attributes at hand and turned into a plan for the sweep.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pointsweep/operators/operator.h"
#include "pointsweep/pipeline/kept_fields.h"
#include "pointsweep/points/neighborhood.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

/// Neighbourhoods, and what is computed from them, in order.
struct Chain {
  Neighborhood neighborhood;
  std::vector<std::shared_ptr<const Operator>> operators;
  /// What to write, of the made attributes and of the input's, by name (kept_fields.h); empty: everything.
  std::vector<std::string> keep = {};
};

/// A plan whose file columns are still names, and the attributes that will be written.
struct PlannedChain {
  SweepPlan plan;
  /// For each of plan.file_columns, the fields of the input it is made of.
  std::vector<std::vector<std::string>> file_fields;
  /// The last version of every attribute made and kept, in the order first made; result records hold them one after
  /// another.
  std::vector<Attribute> made;
  /// What of these and of the input is written.
  KeptFields kept;

  /// Indices of the input's fields that must travel with the points.
  std::vector<std::size_t> payload(const Schema& input) const;
  /// Turns the names into fields of the working record.
  void bind(const Schema& working_record);
};

/// Throws UsageError in a sentence naming the stage when k is 0, a radius is negative, or an operator reads an
/// attribute that neither the input nor an earlier stage has, a rule of neighbourhoods one that the input has not, and
/// when an attribute to keep is neither made nor the input's. `input` names the cloud's fields.
PlannedChain plan_chain(const Chain& chain, const Schema& input);

}  // namespace pointsweep
