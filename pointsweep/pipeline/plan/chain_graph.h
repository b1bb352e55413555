// SPDX-License-Identifier: MIT
/// A chain resolved against the attributes of a cloud: its nodes, and the version of each attribute that a node reads.
/// resolve() expands composites and binds conditions, once for all code that plans or runs the chain.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// One version of an attribute: as the input has it, or as a node makes it. No version is ever overwritten.
struct AttributeVersion {
  Attribute attribute;
  std::optional<std::size_t> producer = {};  ///< the node that makes the version; absent if the input has it
};

/// A node. Versions are indices into ChainGraph::versions, nodes are indices into ChainGraph::nodes.
struct GraphNode {
  /// The content: an operator, the neighbourhood of the operators up to the next neighbourhood, or a value that is
  /// reduced from the whole cloud.
  std::variant<StageOperator, Neighborhood, std::shared_ptr<const Reduction>> what;
  std::string stage = {};               ///< name of the operator, or of its composite; empty for other nodes
  std::vector<std::size_t> reads = {};  ///< versions, in the order of the reads of `what`
  std::vector<std::size_t> reads_neighbors = {};
  std::vector<std::size_t> makes = {};
  std::vector<std::size_t> values = {};      ///< reduce nodes (with a Reduction) whose values the operator needs
  std::optional<std::size_t> position = {};  ///< version of the position that the node sees; absent: the input's

  /// Returns the operator; null for other nodes.
  const StageOperator* op() const { return std::get_if<StageOperator>(&what); }
  const Neighborhood* neighborhood() const { return std::get_if<Neighborhood>(&what); }
  const Reduction* reduction() const {
    const auto* shared = std::get_if<std::shared_ptr<const Reduction>>(&what);
    return shared != nullptr ? shared->get() : nullptr;
  }
  bool drops_rows() const { return op() != nullptr && pointsweep::drops_rows(*op()); }
  /// Returns whether the node is a Resort. Only the last Resort may make an attribute.
  bool is_order() const { return op() != nullptr && std::holds_alternative<NotePosition>(*op()); }
};

struct ChainGraph {
  std::vector<GraphNode> nodes;  ///< the first is the neighbourhood with which the chain begins
  std::vector<AttributeVersion> versions;
  /// The last version of every made attribute that no later stage drops, in the order in which the attributes were
  /// first made (after a drop: made again). selection_attribute() and stream_position_attribute() are not among them.
  std::vector<std::size_t> made;
  /// The node whose Reduction finds the box of the moved positions, if the output needs this box before its first
  /// record.
  std::optional<std::size_t> moved_bounds;
  /// Indices of the input's fields that a stage drops.
  std::set<std::size_t> dropped;
  bool drops = false;  ///< true if a stage drops attributes, of the input or made ones

  std::vector<Attribute> made_attributes() const;
  bool drops_rows() const;
  /// Returns whether a node reads the number of a point's row in the inputs (input_row.h).
  bool reads_input_rows() const;
  /// Returns whether the chain has a Resort.
  bool has_order() const;
};

/// Requirements of an output on the plan of a chain.
struct OutputNeeds {
  bool stream_order = false;  ///< the output has its points in stream order, which the last Resort decides
  bool bounds = false;        ///< its format needs the box of moved points before the first record
};

/// Resolves a chain for a cloud with the fields of `input`. Throws UsageError if the chain does not fit the fields, for
/// example if k is 0, a radius is negative, an operator reads an attribute that neither the input nor an earlier stage
/// has, a rule of neighbourhoods reads an attribute that the cloud does not have, or a Drop names fields that cannot be
/// dropped.
ChainGraph resolve(const Chain& chain, const Schema& input, OutputNeeds needs);

/// Returns `before`, in which attributes of `made` replace the attributes with the same names. Other attributes of
/// `made` are appended.
std::vector<Attribute> updated(std::vector<Attribute> before, const std::vector<Attribute>& made);

/// Returns `input` with the fields of `carried`: attributes that earlier passes made, whose values follow the record of
/// `input` one after another. A carried field takes the index and the name of the field of `input` with the same name
/// in any spelling (Schema::find()).
Schema with_carried(const Schema& input, const std::vector<Attribute>& carried);

/// Returns the offset of the attribute `name` in records that hold the values of `attributes` one after another;
/// nullopt if it is not among them.
std::optional<std::size_t> offset_in(const std::vector<Attribute>& attributes, std::string_view name);

/// Returns the name of the attribute of `carried` that holds `field`; empty if the record of `input` holds the field,
/// or nothing does.
std::string carried_with(std::string_view field, const Schema& input, const std::vector<Attribute>& carried);

}  // namespace pointsweep
