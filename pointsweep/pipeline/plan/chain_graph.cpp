// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/plan/chain_graph.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/operators/kinds/box_reductions.h"
#include "pointsweep/pipeline/plan/kept_fields.h"
#include "pointsweep/points/input_row.h"

namespace pointsweep {
namespace {

using Attributes = std::vector<Attribute>;

std::string field_names(const Schema& schema) {
  std::string names;
  for (const Field& field : without_input_row(schema).fields) names += (names.empty() ? "" : ", ") + field.name;
  return names;
}

void require_neighbors(const Neighborhood& neighborhood) {
  if (neighborhood.k == 0) fail_usage("k = 0 gives no neighbours: choose k of at least 1.");
  if (!(neighborhood.radius >= 0))
    fail_usage("The radius {} is not a distance: choose one of at least 0.", neighborhood.radius);
}

class GraphBuilder {
 public:
  explicit GraphBuilder(const Schema& input) : input_(with_input_row(input)), visible_(input_) {}

  void add(const Neighborhood& neighborhood) {
    require_neighbors(neighborhood);
    GraphNode node{.what = neighborhood};
    if (neighborhood.rule)
      for (const Attribute& a : neighborhood.rule->reads())
        node.reads.push_back(version_ruled_by(a, *neighborhood.rule));
    neighborhood_ = neighborhood;
    graph_.nodes.push_back(std::move(node));
  }
  /// Throws UsageError for a composite with a Reneighbor that leaves k to the operators (kOfOperators), since the
  /// contract of the composite does not state k.
  void operator()(const Reneighbor& update) {
    if (update.neighborhood && update.neighborhood->k == Neighborhood::kOfOperators)
      fail_usage("{}: states no k for the Reneighbor inside it; set Neighborhood::k there.", is_part_of_);
    add(Neighborhood(update.neighborhood ? *update.neighborhood : neighborhood_));
  }
  void operator()(const Resort&) {
    graph_.nodes.push_back({.what = StageOperator(NotePosition()), .position = position_});
  }
  void operator()(const Drop& drop) { this->drop(drop.attributes); }
  void operator()(const std::shared_ptr<const CompositeOperator>& op) {
    const std::string name = is_part_of_.empty() ? op->name() : is_part_of_;
    const std::vector<ChainStage> parts = op->parts();
    for (const ChainStage& part : parts)
      if (const auto* helpers = std::get_if<Drop>(&part)) refuse_any(helpers->attributes, name);
    for (const ChainStage& part : parts) {
      is_part_of_ = name;
      std::visit(*this, part);
    }
    is_part_of_.clear();
  }
  /// Adds an operator of one of the kinds of StageOperator.
  template <class Kind>
  void operator()(const std::shared_ptr<const Kind>& op) {
    add(StageOperator(op));
  }

  ChainGraph finish(OutputNeeds needs) {
    if (needs.stream_order) note_stream_position();
    if (needs.bounds && position_) find_moved_bounds();
    for (const Attribute& a : made_) graph_.made.push_back(latest_.at(a.name));
    return std::move(graph_);
  }

 private:
  void add(const StageOperator& stage) {
    const StageOperator op = bound_to_visible(bound_to_other_cloud(stage));
    const Contract contract = contract_of(op);
    const std::string name = name_of(op);
    GraphNode node{.what = op, .stage = is_part_of_.empty() ? name : is_part_of_, .position = position_};
    for (const Attribute& a : contract.reads) node.reads.push_back(version_read(a, name));
    for (const Attribute& a : contract.reads_neighbors) node.reads_neighbors.push_back(version_read(a, name));
    for (const auto& reduction : contract.values) node.values.push_back(reduce_node(reduction, name));
    const std::size_t number = graph_.nodes.size();
    for (const Attribute& a : contract.makes)
      node.makes.push_back(a.name == selection_attribute().name ? new_version(a, number) : make(a, number));
    if (node.drops_rows()) ++drops_rows_;
    graph_.nodes.push_back(std::move(node));
  }

  /// Binds an operator to the fields of the other cloud if it reads attributes of that cloud.
  static StageOperator bound_to_other_cloud(const StageOperator& stage) {
    const auto* const op = std::get_if<std::shared_ptr<const InOrderOperator>>(&stage);
    if (op == nullptr || (*op)->other_reads().empty()) return stage;
    return (*op)->bound_to_other(opened_cloud((*op)->other_cloud(), true)->schema());
  }

  StageOperator bound_to_visible(const StageOperator& op) const {
    try {
      return bound(op, visible_, made_);
    } catch (const UsageError& error) {
      if (dropped_.empty()) throw;
      throw UsageError(fmt::format("{} Dropped before: {}.", error.what(), fmt::join(dropped_, ", ")));
    }
  }

  /// Throws UsageError if the input or an earlier stage has an attribute named like one of `helpers`, which the
  /// composite `stage` makes and drops again.
  void refuse_any(const std::vector<std::string>& helpers, const std::string& stage) const {
    for (const std::string& name : helpers)
      if (visible_.find(name) || std::ranges::find(made_, name, &Attribute::name) != made_.end())
        fail_usage(
            "{0}: there is an attribute '{1}', which the stage makes for itself and leaves out; drop({1}) or a set "
            "under another name before it lets it run.",
            stage, name);
  }

  void drop(const std::vector<std::string>& names) {
    graph_.drops = true;
    NamedFields named = named_fields(names, made_, without_input_row(visible_), "dropped");
    for (const Attribute& a : made_) drop_made(a, named);
    std::set<std::size_t> left_out;
    for (std::size_t f = 0; f < visible_.fields.size(); ++f)
      if (named.input.contains(f) || named.made.contains(visible_.fields[f].name)) left_out.insert(f);
    for (const char* axis : {"x", "y", "z"})
      if (const auto at = visible_.find(axis); (at && left_out.contains(*at)) || named.made.contains(axis))
        fail_usage("drop: x, y and z are always written; leave out '{}'.", axis);
    std::erase_if(made_, [&](const Attribute& a) { return named.made.contains(a.fields.front()); });
    for (const std::string& field : named.made) dropped_.insert(field);
    Schema visible{{}, visible_.stride};
    for (std::size_t f = 0; f < visible_.fields.size(); ++f) {
      const Field& field = visible_.fields[f];
      if (!left_out.contains(f)) {
        visible.fields.push_back(field);
        continue;
      }
      dropped_.insert(field.name);
      const auto own = std::ranges::find(input_.fields, field);
      graph_.dropped.insert(static_cast<std::size_t>(own - input_.fields.begin()));
    }
    visible_ = std::move(visible);
    std::erase_if(latest_, [&](const auto& known) { return !is_visible(graph_.versions[known.second]); });
  }

  /// Refuses to drop only some of the fields of a made attribute.
  static void drop_made(const Attribute& a, const NamedFields& named) {
    const auto is_named = [&](const std::string& field) { return named.made.contains(field); };
    if (std::ranges::all_of(a.fields, is_named) || std::ranges::none_of(a.fields, is_named)) return;
    const std::string field = *std::ranges::find_if(a.fields, is_named);
    fail_usage(
        "drop: '{}' is a part of '{}', which is made; name '{}' as a whole, or choose what is written by --keep.",
        field, a.name, a.name);
  }

  bool is_visible(const AttributeVersion& version) const {
    if (version.producer) return std::ranges::find(made_, version.attribute.name, &Attribute::name) != made_.end();
    return std::ranges::all_of(version.attribute.fields,
                               [&](const std::string& field) { return field_meant(visible_, field).has_value(); });
  }

  /// Returns the version of `wanted` that the cloud has after the stages before the neighbourhoods of `rule`. Throws
  /// UsageError if the cloud then has no such attribute, or has it as an array.
  std::size_t version_ruled_by(const Attribute& wanted, const NeighborhoodRule& rule) {
    const Schema cloud = with_carried(visible_, made_);
    const auto meant = field_meant(cloud, wanted.name);
    if (!meant)
      fail_usage("The neighbours are to be {}, but the input has no attribute '{}'; it has {}.", rule.meaning(),
                 wanted.name, field_names(cloud));
    if (const std::size_t values = cloud.fields[*meant].count; values != 1)
      fail_usage("The neighbours are to be {}, but '{}' is an array of {}, not a single value.", rule.meaning(),
                 wanted.name, values);
    const std::string made = carried_with(wanted.name, input_, made_);
    return made.empty() ? input_version(wanted) : latest_.at(made);
  }

  /// Returns the number of the node that computes `reduction`. Equal reductions of the same versions over the same rows
  /// share a node.
  std::size_t reduce_node(const std::shared_ptr<const Reduction>& reduction, const std::string& stage) {
    GraphNode node{.what = reduction};
    for (const Attribute& a : reduction->reads()) {
      const bool made = !reduction->of_input() && latest_.contains(a.name);
      if (!made) require_in_input(a, stage);
      node.reads.push_back(made ? latest_.at(a.name) : input_version(a));
    }
    const auto [known, is_new] =
        reduce_nodes_.try_emplace({reduction->text(), node.reads, drops_rows_}, graph_.nodes.size());
    if (is_new) graph_.nodes.push_back(std::move(node));
    return known->second;
  }

  std::size_t version_read(const Attribute& wanted, const std::string& stage) {
    if (!latest_.contains(wanted.name)) {
      require_in_input(wanted, stage);
      latest_[wanted.name] = input_version(wanted);
    }
    const std::size_t version = latest_.at(wanted.name);
    const Attribute& has = graph_.versions[version].attribute;
    if (has.type != wanted.type || has.fields.size() != wanted.fields.size()) {
      fail_usage("{}: needs '{}' as {} x {}, but it is made as {} x {}.", stage, wanted.name, wanted.fields.size(),
                 name_of(wanted.type), has.fields.size(), name_of(has.type));
    }
    return version;
  }

  void require_in_input(const Attribute& wanted, const std::string& stage) const {
    for (const std::string& name : wanted.fields) {
      if (field_meant(visible_, name)) continue;
      if (dropped_.contains(name))
        fail_usage("{}: needs '{}', which was dropped before; put drop after '{}'.", stage, wanted.name, stage);
      fail_usage(
          "{}: needs '{}', which no earlier stage makes and the input does not have. Add the operator that makes "
          "it before '{}'.",
          stage, wanted.name, stage);
    }
  }

  std::size_t input_version(const Attribute& wanted) {
    const auto [known, is_new] = of_input_.try_emplace({wanted.name, wanted.type}, graph_.versions.size());
    if (is_new) graph_.versions.push_back({.attribute = wanted});
    return known->second;
  }

  std::size_t new_version(const Attribute& a, std::size_t node) {
    graph_.versions.push_back({.attribute = a, .producer = node});
    return graph_.versions.size() - 1;
  }

  std::size_t make(const Attribute& a, std::size_t node) {
    const std::size_t version = new_version(a, node);
    latest_[a.name] = version;
    made_ = updated(std::move(made_), {a});
    if (a.name == position_attribute().name) position_ = version;
    return version;
  }

  /// Lets the last Resort, which decides the order of the output, make stream_position_attribute() if points may have
  /// moved before it.
  void note_stream_position() {
    for (std::size_t n = graph_.nodes.size(); n-- > 0;) {
      if (!graph_.nodes[n].is_order()) continue;
      if (!graph_.nodes[n].position) return;
      graph_.nodes[n].makes = {new_version(stream_position_attribute(), n)};
      return;
    }
  }

  void find_moved_bounds() {
    graph_.moved_bounds = graph_.nodes.size();
    graph_.nodes.push_back({.what = std::make_shared<const MovedBounds>(), .reads = {*position_}});
  }

  const Schema input_;             ///< fields of the input, with the row of each point, which stages may read
  Schema visible_;                 ///< fields of the input that are not dropped
  std::set<std::string> dropped_;  ///< names of dropped fields
  ChainGraph graph_;
  std::string is_part_of_;  ///< name of the composite whose parts are being added; empty: none
  Neighborhood neighborhood_;
  Attributes made_;                            ///< attributes made and not dropped, in their last versions
  std::map<std::string, std::size_t> latest_;  ///< current version of each attribute, by name
  /// Version of each attribute of the input that a node reads, by name and type.
  std::map<std::pair<std::string, Type>, std::size_t> of_input_;
  std::map<std::tuple<std::string, std::vector<std::size_t>, std::size_t>, std::size_t> reduce_nodes_;
  std::size_t drops_rows_ = 0;           ///< number of stages so far that drop rows
  std::optional<std::size_t> position_;  ///< version of the moved positions; absent: no stage moves points
};

}  // namespace

std::vector<Attribute> updated(std::vector<Attribute> before, const std::vector<Attribute>& made) {
  for (const Attribute& a : made) {
    const auto known = std::ranges::find(before, a.name, &Attribute::name);
    known == before.end() ? before.push_back(a) : void(*known = a);
  }
  return before;
}

Schema with_carried(const Schema& input, const std::vector<Attribute>& carried) {
  Schema schema = input;
  for (const Attribute& a : carried) {
    for (const std::string& name : a.fields) {
      const auto known = input.find(name);
      const std::size_t added = schema.append(known ? input.fields[*known].name : name, a.type);
      if (!known) continue;
      schema.fields[*known] = schema.fields[added];
      schema.fields.pop_back();
    }
  }
  return schema;
}

std::optional<std::size_t> offset_in(const std::vector<Attribute>& attributes, std::string_view name) {
  std::size_t offset = 0;
  for (const Attribute& a : attributes) {
    if (a.name == name) return offset;
    offset += a.bytes();
  }
  return std::nullopt;
}

std::string carried_with(std::string_view field, const Schema& input, const std::vector<Attribute>& carried) {
  const Schema cloud = with_carried(input, carried);
  const auto at = field_meant(cloud, field);
  std::size_t end = input.stride;
  for (const Attribute& a : carried) {
    const std::size_t begin = end;
    end += a.bytes();
    if (at && cloud.fields[*at].offset >= begin && cloud.fields[*at].offset < end) return a.name;
  }
  return "";
}

std::vector<Attribute> ChainGraph::made_attributes() const {
  Attributes attributes;
  for (const std::size_t v : made) attributes.push_back(versions[v].attribute);
  return attributes;
}

bool ChainGraph::drops_rows() const { return std::ranges::any_of(nodes, &GraphNode::drops_rows); }
bool ChainGraph::reads_input_rows() const {
  return std::ranges::any_of(versions, [](const AttributeVersion& v) { return v.attribute.name == kInputRow; });
}
bool ChainGraph::has_order() const { return std::ranges::any_of(nodes, &GraphNode::is_order); }

ChainGraph resolve(const Chain& chain, const Schema& input, OutputNeeds needs) {
  GraphBuilder builder(input);
  builder.add(chain.neighborhood);
  for (const ChainStage& stage : chain.stages) std::visit(builder, stage);
  return builder.finish(needs);
}

}  // namespace pointsweep
