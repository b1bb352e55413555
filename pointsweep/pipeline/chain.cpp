// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/chain.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "pointsweep/error.h"

namespace pointsweep {

namespace {

std::string names_of(const Schema& schema) {
  std::string names;
  for (const Field& field : schema.fields) names += (names.empty() ? "" : ", ") + field.name;
  return names;
}

class Planner {
 public:
  Planner(const Schema& input, PlannedChain& out) : input_(input), out_(out), plan_(out.plan) { plan_.steps = {0}; }

  /// A rule looks at points as they come, before any stage.
  void add(const NeighborhoodRule& rule) {
    for (const Attribute& a : rule.reads()) {
      if (!input_.find(a.name))
        fail_usage("The neighbours are to be {}, but the input has no attribute '{}'; it has {}.", rule.meaning(),
                   a.name, names_of(input_));
      plan_.rule_reads.push_back(file_column(a));
    }
  }

  void add(const std::shared_ptr<const Operator>& op) {
    const Contract contract = op->contract();
    Stage stage{.op = op, .reads = {}, .reads_neighbors = {}, .makes = {}, .position = position_};
    for (const Attribute& a : contract.reads) stage.reads.push_back(column_of(a, *op));
    // Every stage behind one that moves points reads the moved positions of the neighbours.
    bool looks_at_this_step =
        !contract.alone && position_ >= 0 && made_in_this_step(static_cast<std::uint16_t>(position_));
    for (const Attribute& a : contract.reads_neighbors) {
      stage.reads_neighbors.push_back(column_of(a, *op));
      looks_at_this_step |= made_in_this_step(stage.reads_neighbors.back());
    }
    if (looks_at_this_step) plan_.steps.push_back(plan_.stages.size());
    for (const Attribute& a : contract.makes) stage.makes.push_back(make(a));
    plan_.stages.push_back(std::move(stage));
  }

  void finish(const std::vector<std::string>& keep) {
    keep_only(keep);
    plan_.steps.push_back(plan_.stages.size());
    std::uint32_t offset = 0;
    for (const Attribute& a : out_.made) {
      const auto bytes = static_cast<std::uint32_t>(a.bytes());
      plan_.results.push_back({latest_.at(a.name).column, offset, bytes});
      offset += bytes;
    }
    plan_.result_bytes = offset;
    find_lasting();
  }

 private:
  /// Who reads a column says how long it lasts.
  void find_lasting() {
    const auto outlasts = [&](std::uint16_t column, std::size_t step) {
      const auto made = made_in_step_.find(column);
      return made == made_in_step_.end() || made->second != step;
    };
    const auto read = [&](std::uint16_t column, std::size_t step) {
      const Lasting by_it = outlasts(column, step) ? Lasting::its_cell : Lasting::its_step;
      plan_.lasting[column] = std::max(plan_.lasting[column], by_it);
    };
    plan_.lasting.assign(plan_.column_bytes.size(), Lasting::not_at_all);
    for (const FileColumn& file : plan_.file_columns) plan_.lasting[file.column] = Lasting::its_cell;
    for (const ResultColumn& result : plan_.results) read(result.column, plan_.step_count() - 1);
    for (std::size_t step = 0; step < plan_.step_count(); ++step) {
      for (std::size_t s = plan_.steps[step]; s < plan_.steps[step + 1]; ++s) {
        const Stage& stage = plan_.stages[s];
        for (const std::uint16_t column : stage.reads) read(column, step);
        for (const std::uint16_t column : stage.reads_neighbors) plan_.lasting[column] = Lasting::its_cell;
        if (stage.position >= 0) plan_.lasting[static_cast<std::size_t>(stage.position)] = Lasting::its_cell;
      }
    }
  }

  struct Version {
    Attribute attribute;
    std::uint16_t column;
  };

  bool made_in_this_step(std::uint16_t column) const {
    const auto made = made_in_step_.find(column);
    return made != made_in_step_.end() && made->second == plan_.steps.size() - 1;
  }

  void keep_only(const std::vector<std::string>& keep) {
    if (keep.empty()) return;
    out_.kept = kept_fields(keep, out_.made, input_);
    const std::vector<std::string>& kept = out_.kept.attributes;
    std::erase_if(out_.made, [&](const Attribute& a) { return std::ranges::find(kept, a.name) == kept.end(); });
  }

  std::uint16_t new_column(const Attribute& a) {
    plan_.column_bytes.push_back(static_cast<std::uint32_t>(a.bytes()));
    return static_cast<std::uint16_t>(plan_.column_bytes.size() - 1);
  }

  std::uint16_t column_of(const Attribute& wanted, const Operator& op) {
    const auto known = latest_.find(wanted.name);
    if (known != latest_.end()) {
      const Attribute& has = known->second.attribute;
      if (has.type != wanted.type || has.fields.size() != wanted.fields.size()) {
        fail_usage("{}: needs '{}' as {} x {}, but it is made as {} x {}.", op.name(), wanted.name,
                   wanted.fields.size(), name_of(wanted.type), has.fields.size(), name_of(has.type));
      }
      return known->second.column;
    }
    for (const std::string& name : wanted.fields) {
      if (input_.find(name)) continue;
      fail_usage(
          "{}: needs '{}', which no earlier stage makes and the input does not have. Add the operator that makes "
          "it before '{}'.",
          op.name(), wanted.name, op.name());
    }
    const std::uint16_t column = file_column(wanted);
    latest_[wanted.name] = {wanted, column};
    return column;
  }

  /// A new column of what the input has.
  std::uint16_t file_column(const Attribute& wanted) {
    std::vector<std::string> fields;
    for (const std::string& name : wanted.fields) fields.push_back(input_.fields[*input_.find(name)].name);
    const std::uint16_t column = new_column(wanted);
    plan_.file_columns.push_back({column, {}, wanted.type});
    out_.file_fields.push_back(std::move(fields));
    return column;
  }

  std::uint16_t make(const Attribute& a) {
    const std::uint16_t column = new_column(a);
    latest_[a.name] = {a, column};
    made_in_step_[column] = plan_.steps.size() - 1;
    if (a.name == position_attribute().name) position_ = column;
    const auto same = [&](const Attribute& b) { return b.name == a.name; };
    const auto known = std::find_if(out_.made.begin(), out_.made.end(), same);
    known == out_.made.end() ? out_.made.push_back(a) : void(*known = a);
    return column;
  }

  const Schema& input_;
  PlannedChain& out_;
  SweepPlan& plan_;
  std::map<std::string, Version> latest_;
  std::map<std::uint16_t, std::size_t> made_in_step_;  ///< by column
  int position_ = -1;                                  ///< column of the moved positions, if an operator has moved them
};

}  // namespace

PlannedChain plan_chain(const Chain& chain, const Schema& input) {
  if (chain.neighborhood.k == 0) fail_usage("k = 0 gives no neighbours: choose k of at least 1.");
  if (!(chain.neighborhood.radius >= 0)) {
    fail_usage("The radius {} is not a distance: choose one of at least 0.", chain.neighborhood.radius);
  }
  PlannedChain out;
  out.plan.neighborhood = chain.neighborhood;
  Planner planner(input, out);
  if (chain.neighborhood.rule) planner.add(*chain.neighborhood.rule);
  for (const auto& op : chain.operators) planner.add(op);
  planner.finish(chain.keep);
  return out;
}

std::vector<std::size_t> PlannedChain::payload(const Schema& input) const {
  std::vector<std::size_t> indices;
  for (const auto& names : file_fields) {
    for (const std::string& name : names) {
      const auto at =
          std::find_if(input.fields.begin(), input.fields.end(), [&](const Field& f) { return f.name == name; });
      const auto index = static_cast<std::size_t>(at - input.fields.begin());
      if (std::find(indices.begin(), indices.end(), index) == indices.end()) indices.push_back(index);
    }
  }
  return indices;
}

void PlannedChain::bind(const Schema& working_record) {
  for (std::size_t c = 0; c < file_fields.size(); ++c) {
    plan.file_columns[c].fields.clear();
    for (const std::string& name : file_fields[c]) {
      const auto at = std::find_if(working_record.fields.begin(), working_record.fields.end(),
                                   [&](const Field& f) { return f.name == name; });
      plan.file_columns[c].fields.push_back(static_cast<std::size_t>(at - working_record.fields.begin()));
    }
  }
}

}  // namespace pointsweep
