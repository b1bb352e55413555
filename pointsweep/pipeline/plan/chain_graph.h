// SPDX-License-Identifier: MIT
/// A chain resolved against the attributes of a cloud: its nodes, and the version of each attribute that a node reads.
/// Composites are expanded and conditions are bound here, once. All code that needs to know the chain reads the graph.
#pragma once

#include <cstddef>
#include <cstdint>
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

/// The points whose values a node reads when it reads a version of an attribute.
enum class ReadAs : std::uint8_t {
  self,         ///< the value of the point itself
  neighbors,    ///< the values of its neighbours
  whole_cloud,  ///< the values of all points that are left
};

struct VersionReader {
  std::size_t node;
  ReadAs as;
};

/// An attribute of the input, or made by a node. No version is ever overwritten.
struct AttributeVersion {
  Attribute attribute;
  std::size_t version = 0;                   ///< 0: the input's; the first that is made is 1
  std::optional<std::size_t> producer = {};  ///< the node that makes it; absent: the input
  std::vector<VersionReader> readers = {};   ///< in the order of the nodes
  bool is_written = false;                   ///< written to the output
};

/// A node. Versions are indices into ChainGraph::versions, nodes are indices into ChainGraph::nodes.
struct GraphNode {
  /// An operator; the definition of neighbourhoods from here on; or a value of the whole cloud.
  std::variant<StageOperator, Neighborhood, std::shared_ptr<const Reduction>> what;
  std::string stage = {};               ///< name of the chain's stage that the operator is, or a part of
  std::vector<std::size_t> reads = {};  ///< versions, in the order of the contract
  std::vector<std::size_t> reads_neighbors = {};
  std::vector<std::size_t> makes = {};
  std::vector<std::size_t> values = {};      ///< the reduce nodes whose values it needs
  std::optional<std::size_t> position = {};  ///< version of the moved positions that it sees; absent: the input's

  /// Returns the operator; null for other nodes.
  const StageOperator* op() const { return std::get_if<StageOperator>(&what); }
  const Neighborhood* neighborhood() const { return std::get_if<Neighborhood>(&what); }
  const Reduction* reduction() const {
    const auto* shared = std::get_if<std::shared_ptr<const Reduction>>(&what);
    return shared != nullptr ? shared->get() : nullptr;
  }
  bool drops_rows() const { return op() != nullptr && pointsweep::drops_rows(*op()); }
  /// Returns whether the node is a Resort. Only the deciding one makes an attribute.
  bool is_order() const { return op() != nullptr && std::holds_alternative<NotePosition>(*op()); }
};

struct ChainGraph {
  std::vector<GraphNode> nodes;  ///< the first is the neighbourhood with which the chain begins
  std::vector<AttributeVersion> versions;
  /// The last version of every made attribute, in the order first made; without selections and orders.
  std::vector<std::size_t> made;
  /// The reduce node that finds the box of the moved positions, if the output needs it before its first record.
  std::optional<std::size_t> moved_bounds;
  /// Indices of the input's fields that a stage drops.
  std::set<std::size_t> dropped;
  bool drops = false;  ///< a stage drops some of these, or something made

  std::vector<Attribute> made_attributes() const;
  bool drops_rows() const;
  /// Returns whether a node reads the number of a point's row in the inputs (input_row.h).
  bool reads_input_rows() const;
  /// Returns whether the chain has a Resort.
  bool has_order() const;
};

/// Requirements of an output on the plan of a chain.
struct OutputNeeds {
  bool stream_order = false;  ///< its points are in stream order, so that the last Resort counts
  bool bounds = false;        ///< its format needs the box of moved points before the first record
};

/// Throws UsageError in a sentence that names the stage when k is 0, a radius is negative, an operator reads an
/// attribute that neither the input nor an earlier stage has, or a rule of neighbourhoods reads an attribute that the
/// cloud does not have. `input` names the cloud's fields.
ChainGraph resolve(const Chain& chain, const Schema& input, OutputNeeds needs);

/// Returns `before` with the newer versions and the new attributes of `made`.
std::vector<Attribute> updated(std::vector<Attribute> before, const std::vector<Attribute>& made);

/// `input` with the values of `carried`, which follow its record one after another, instead of its fields of the same
/// names.
Schema with_carried(const Schema& input, const std::vector<Attribute>& carried);

/// Returns the attribute of `carried` that holds `field`. Empty if the input's own record holds the field, or nothing
/// does.
std::string carried_with(std::string_view field, const Schema& input, const std::vector<Attribute>& carried);

}  // namespace pointsweep
