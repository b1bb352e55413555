// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/plan/pass_schedule.h"

#include <algorithm>
#include <map>
#include <string>

#include "pointsweep/fail.h"
#include "pointsweep/overloaded.h"

namespace pointsweep {
namespace {

/// Returns the names of the attributes that a contract reads. The position is always among them: every stage may read
/// the position of the point, and a stage that reads neighbours may read their positions.
std::vector<std::string> read_by(const Contract& contract) {
  std::vector<std::string> names = {position_attribute().name};
  for (const auto* attributes : {&contract.reads, &contract.reads_neighbors})
    for (const Attribute& a : *attributes) names.push_back(a.name);
  return names;
}

bool connects(const StageOperator& op) { return std::holds_alternative<std::shared_ptr<const ConnectOperator>>(op); }

/// Returns whether a stage of the first segment needs a value of the input, for which the rows are read first.
bool begins_with_input_values(const ChainGraph& graph) {
  bool any_stage = false;
  for (const GraphNode& node : graph.nodes) {
    if (node.drops_rows() || (node.neighborhood() != nullptr && any_stage)) return false;
    if (node.reduction() != nullptr && node.reduction()->of_input()) return true;
    any_stage |= node.op() != nullptr && !node.is_order();
  }
  return false;
}

/// The state of schedule_passes(): the passes planned so far.
class PassSchedule {
 public:
  explicit PassSchedule(const ChainGraph& graph) : graph_(graph) {
    if (begins_with_input_values(graph)) new_pass(PassKind::rows);
  }

  /// Returns the passes. A pass with only pointwise stages needs no search, so it becomes a pass over the rows.
  std::vector<ScheduledPass> passes() {
    for (std::size_t n = 1; n < graph_.nodes.size(); ++n) add(n);
    const auto needs_no_search = [&](std::size_t n) { return is_pointwise(*graph_.nodes[n].op()); };
    for (ScheduledPass& pass : passes_)
      if (pass.kind == PassKind::sweep && std::ranges::all_of(pass.stages, needs_no_search)) pass.kind = PassKind::rows;
    return std::move(passes_);
  }

 private:
  /// Numbers of the passes between which an attribute may be read.
  struct Use {
    /// The first pass that can read the attribute: the pass of the stage that makes it, or the pass after it if the
    /// stage connects neighbours; the first pass of the segment if none of its stages makes the attribute.
    std::size_t known_from = 0;
    /// The last pass planned so far that reads or makes the attribute, or follows a pass that reduces it. No earlier
    /// pass may change the attribute.
    std::size_t last_read = 0;
    bool is_made = false;  ///< made by a stage of this segment
  };

  void add(std::size_t node) {
    std::visit(overloaded{[&](const StageOperator& op) { add(node, op); },
                          [&](const Neighborhood&) {
                            neighborhood_ = node;
                            begin_segment();
                          },
                          // known_after_values() assigns reductions to passes.
                          [](const std::shared_ptr<const Reduction>&) {}},
               graph_.nodes[node].what);
  }

  void add(std::size_t node, const StageOperator& op) {
    std::visit(
        overloaded{[&](const std::shared_ptr<const LocalOperator>&) { add_stage(node, op); },
                   [&](const std::shared_ptr<const SelectOperator>&) { add_select(node); },
                   [&](const std::shared_ptr<const InOrderOperator>& in_order) { add_in_order(node, *in_order); },
                   [&](const std::shared_ptr<const ConnectOperator>&) { add_stage(node, op); },
                   [&](const NotePosition&) {
                     if (!graph_.nodes[node].makes.empty()) add_stage(node, op);
                   }},
        op);
  }

  void add_stage(std::size_t node, const StageOperator& op) {
    const Contract contract = contract_of(op);
    const std::size_t readable = first_pass_for(contract), known = known_after_values(graph_.nodes[node].values);
    const std::size_t pass = pass_for(op, contract, std::max(readable, known));
    passes_[pass].stages.push_back(node);
    passes_[pass].connects |= connects(op);
    note_use(contract, pass, connects(op) ? pass + 1 : pass);
  }

  void add_in_order(std::size_t node, const InOrderOperator& op) {
    ScheduledPass& pass = new_pass(PassKind::order);
    if (op.in_order_contract().drops_rows) return end_rows_with(pass, node);
    pass.stages.push_back(node);
    note_use(op.contract(), passes_.size() - 1, passes_.size() - 1);
  }

  void add_select(std::size_t node) {
    const bool last_may =
        passes_.size() > segment_ && passes_.back().kind == PassKind::rows && passes_.back().reduces.empty();
    end_rows_with(last_may ? passes_.back() : new_pass(PassKind::rows), node);
  }

  /// Adds a node that drops rows as the last node of its segment: all nodes before it see all rows.
  void end_rows_with(ScheduledPass& pass, std::size_t node) {
    pass.selects = true;
    pass.stages.push_back(node);
    begin_segment();
  }

  void begin_segment() {
    segment_ = passes_.size();
    used_.clear();
  }

  /// Returns the first pass in which all attributes that the stage reads exist, and after which no earlier stage reads
  /// an attribute that the stage changes.
  std::size_t first_pass_for(const Contract& contract) const {
    std::size_t pass = segment_;
    for (const std::string& name : read_by(contract)) pass = std::max(pass, use_of(name).known_from);
    for (const Attribute& a : contract.makes) {
      const Use use = use_of(a.name);
      pass = std::max({pass, use.known_from, use.last_read});
    }
    return pass;
  }

  /// Returns the pass at whose end the value is known. A value of the rows with which the segment begins is known after
  /// the pass before the segment; at the beginning of the chain, after the first pass, which only reads the rows.
  std::size_t find_value(const Reduction& reduction) {
    if (reduction.of_input()) return segment_ == 0 ? 0 : segment_ - 1;
    std::size_t after = segment_;
    for (const Attribute& a : reduction.reads()) after = std::max(after, use_of(a.name).known_from);
    if (after >= passes_.size()) new_pass(PassKind::rows);
    // The reduction reads the attribute at the end of the pass, so a stage that changes it must come later.
    for (const Attribute& a : reduction.reads()) note_read(a.name, after + 1);
    return after;
  }

  /// Assigns each value that a stage needs to a pass that computes it, and returns the first pass in which all are
  /// known.
  std::size_t known_after_values(const std::vector<std::size_t>& reduces) {
    std::size_t known = 0;
    for (const std::size_t reduce : reduces) {
      if (!value_of_.contains(reduce)) {
        const std::size_t after = value_of_[reduce] = find_value(*graph_.nodes[reduce].reduction());
        passes_[after].reduces.push_back(reduce);
      }
      known = std::max(known, value_of_.at(reduce) + 1);
    }
    return known;
  }

  std::size_t pass_for(const StageOperator& op, const Contract& contract, std::size_t from) {
    const bool alone = is_pointwise(op);
    std::size_t pass = from;
    while (pass < passes_.size() && !takes(passes_[pass], op)) ++pass;
    if (pass >= passes_.size()) {
      const bool follows =
          passes_.size() > segment_ && (passes_.back().kind == PassKind::order || passes_.back().connects);
      new_pass(alone && (follows || !contract.values.empty()) ? PassKind::rows : PassKind::sweep);
      pass = passes_.size() - 1;
    }
    if (!alone) require_search_positions(op, pass);
    return pass;
  }

  bool takes(const ScheduledPass& pass, const StageOperator& op) const {
    if (connects(op)) return pass.kind == PassKind::sweep && !pass.connects;
    return pass.kind == PassKind::sweep || (is_pointwise(op) && pass.kind == PassKind::rows);
  }

  /// Throws UsageError if an earlier pass of the segment moves the points: a sweep searches at the positions that
  /// points have when it begins, so `pass` would not find the neighbours that the stage needs.
  void require_search_positions(const StageOperator& op, std::size_t pass) const {
    const Use positions = use_of(position_attribute().name);
    if (!positions.is_made || positions.known_from >= pass) return;
    fail_usage(
        "{0}: needs a value of the whole cloud and the neighbours that points had before they moved; add reneighbor "
        "before '{0}', or move the points later.",
        name_of(op));
  }

  void note_use(const Contract& contract, std::size_t pass, std::size_t known_from) {
    for (const std::string& name : read_by(contract)) note_read(name, pass);
    for (const Attribute& a : contract.makes)
      used_[a.name] = {.known_from = known_from, .last_read = pass, .is_made = true};
  }

  /// Returns the use of an attribute. An attribute that no stage of this segment has used yet exists from the first
  /// pass of the segment on.
  Use use_of(const std::string& attribute) const {
    const auto used = used_.find(attribute);
    return used != used_.end() ? used->second : Use{segment_, segment_};
  }

  void note_read(const std::string& attribute, std::size_t pass) {
    Use use = use_of(attribute);
    use.last_read = std::max(use.last_read, pass);
    used_[attribute] = use;
  }

  ScheduledPass& new_pass(PassKind kind) {
    ScheduledPass& pass = passes_.emplace_back();
    pass.kind = kind;
    pass.neighborhood = neighborhood_;
    return pass;
  }

  const ChainGraph& graph_;
  std::size_t neighborhood_ = 0;
  std::vector<ScheduledPass> passes_;
  std::size_t segment_ = 0;                      ///< first pass of the current segment
  std::map<std::string, Use> used_;              ///< by attribute, in this segment
  std::map<std::size_t, std::size_t> value_of_;  ///< for each reduce node, the pass after which its value is known
};

}  // namespace

std::vector<ScheduledPass> schedule_passes(const ChainGraph& graph) { return PassSchedule(graph).passes(); }

}  // namespace pointsweep
