// SPDX-License-Identifier: MIT
#include "pointsweep/verify/chain_values.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/points/degenerate_points.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/verify/values/stored_values.h"

namespace pointsweep {
namespace {

using formulas::Estimate;

formulas::Place place_of(const Surroundings& around, std::size_t i) {
  return {{around.x[i], around.y[i], around.z[i]}, 0};
}

bool is_kept(const std::vector<std::string>& keep, const Attribute& a) {
  return keep.empty() || ChainValues::is_selection(a) || std::ranges::find(keep, a.name) != keep.end();
}

/// Splits the points into pieces of kCellCapacity, so that the number of a point is its NeighborRef.
std::vector<PointColumns> slots_of(const Surroundings& around, const std::vector<std::vector<std::byte>>& columns,
                                   const std::vector<Attribute>& attributes, std::vector<const std::byte*>& pointers) {
  const std::size_t count = (around.size() + kCellCapacity - 1) / kCellCapacity;
  pointers.assign(count * columns.size(), nullptr);
  std::vector<PointColumns> slots;
  for (std::size_t s = 0; s < count; ++s) {
    const std::size_t first = s * kCellCapacity;
    const std::byte** own = pointers.data() + s * columns.size();
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (first * attributes[c].bytes() < columns[c].size()) own[c] = columns[c].data() + first * attributes[c].bytes();
    slots.push_back({&around.x[first], &around.y[first], &around.z[first], &around.row[first], own});
  }
  return slots;
}

}  // namespace

ChainValues::ChainValues(std::vector<StageOperator> operators, const std::vector<std::string>& keep,
                         const Schema& input, SharedRule rule, const CloudThreshold& threshold)
    : rule_(std::move(rule)) {
  if (rule_) rule_formula_ = formula_of(*rule_);
  for (const Attribute& a : rule_ ? rule_->reads() : std::vector<Attribute>{}) {
    columns_.push_back(a);
    maker_.push_back(-1);
    rule_reads_.push_back(static_cast<std::uint16_t>(columns_.size() - 1));
    add_file_column(rule_reads_.back(), a, "The rule of neighbourhoods", input);
  }
  int position = -1;
  for (const auto& op : operators) {
    const Contract contract = contract_of(op);
    Stage stage{.op = op, .position = position, .alone = contract.default_k == 0};
    stage.formula = formula_of(*operator_of(op), threshold);
    stage.cloud = cloud_formula_of(*operator_of(op), makers_of_reads(contract));
    stage.alone = stage.alone || stage.cloud;
    for (const Attribute& a : contract.reads) stage.reads.push_back(column_of(a, name_of(op), input));
    if (!stage.cloud)
      for (const Attribute& a : contract.reads_neighbors)
        stage.reads_neighbors.push_back(column_of(a, name_of(op), input));
    for (Attribute a : contract.makes) {
      if (a.name == selection_attribute().name) {
        if (contract.makes.size() > 1) continue;  // selects change no attribute of the rows that stay
        a.name = selection_name(stages_.size());
      }
      make(a, stage);
      if (a.name == position_attribute().name) position = stage.makes.back();
    }
    stages_.push_back(std::move(stage));
  }
  std::erase_if(made_, [&](const Attribute& a) { return !is_kept(keep, a); });
  for (const Attribute& a : made_) made_columns_.push_back(latest_.at(a.name));
  find_rings();
  find_applied();
}

std::string ChainValues::selection_name(std::size_t number) {
  return selection_attribute().name + " by stage " + std::to_string(number);
}

bool ChainValues::is_selection(const Attribute& made) { return made.name.starts_with(selection_attribute().name); }

std::uint16_t ChainValues::new_column(const Attribute& attribute) {
  columns_.push_back(attribute);
  maker_.push_back(-1);
  return latest_[attribute.name] = static_cast<std::uint16_t>(columns_.size() - 1);
}

std::uint16_t ChainValues::column_of(const Attribute& wanted, const std::string& stage, const Schema& input) {
  if (const auto known = latest_.find(wanted.name); known != latest_.end()) return known->second;
  const std::uint16_t column = new_column(wanted);
  add_file_column(column, wanted, stage, input);
  return column;
}

void ChainValues::add_file_column(std::uint16_t column, const Attribute& wanted, const std::string& who,
                                  const Schema& input) {
  std::vector<Field> fields;
  for (const std::string& name : wanted.fields) {
    const auto at = field_meant(input, name);
    if (!at) fail_usage("{}: needs '{}', which neither the input nor an earlier stage has.", who, wanted.name);
    fields.push_back(input.fields[*at]);
  }
  file_columns_.push_back({column, wanted, std::move(fields)});
}

void ChainValues::make(const Attribute& attribute, Stage& stage) {
  stage.makes.push_back(new_column(attribute));
  maker_.back() = static_cast<int>(stages_.size());
  const auto known = std::ranges::find(made_, attribute.name, &Attribute::name);
  known == made_.end() ? made_.push_back(attribute) : void(*known = attribute);
}

/// Finds the rings of neighbours that each stage needs, from the last stage to the first: if a stage reads attributes
/// of neighbours, the attributes are needed one ring farther out.
void ChainValues::find_rings() {
  for (const std::uint16_t column : made_columns_) need(column, 0);
  for (std::size_t s = stages_.size(); s-- > 0;) {
    const Stage& stage = stages_[s];
    if (stage.ring < 0) continue;
    for (const std::uint16_t column : stage.reads) need(column, stage.ring);
    for (const std::uint16_t column : stage.reads_neighbors) need(column, stage.ring + 1);
    if (stage.position >= 0) need(static_cast<std::uint16_t>(stage.position), stage.ring + (stage.alone ? 0 : 1));
  }
}

void ChainValues::need(std::uint16_t column, int ring) {
  if (Stage* const maker = maker_of(column)) maker->ring = std::max(maker->ring, ring);
}

std::size_t ChainValues::result_bytes() const {
  std::size_t bytes = 0;
  for (const Attribute& a : made_) bytes += a.bytes();
  return bytes;
}

std::size_t ChainValues::rings() const {
  int farthest = -1;
  for (const Stage& stage : stages_) farthest = std::max(farthest, stage.ring);
  return static_cast<std::size_t>(farthest + 1);
}

/// Returns the values of the input's columns in both forms, and no values of the other columns.
ChainValues::Values ChainValues::values_of_input(const Surroundings& around, RowSource& in) const {
  Values values{ColumnBytes(columns_.size()), ColumnEstimates(columns_.size())};
  if (file_columns_.empty()) return values;
  std::vector<std::size_t> order(around.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return around.row[a] < around.row[b]; });
  std::vector<std::uint64_t> rows;
  for (const std::size_t i : order) rows.push_back(around.row[i]);
  for (const FileColumn& f : file_columns_) values.bits[f.column].resize(around.size() * f.attribute.bytes());
  for_each_record(in, rows, [&](std::size_t r, const std::byte* record) {
    for (const FileColumn& f : file_columns_) {
      const Type type = f.attribute.type;
      std::byte* const value = values.bits[f.column].data() + order[r] * f.attribute.bytes();
      for (std::size_t c = 0; c < f.fields.size(); ++c) put_value(f.fields[c], record, type, value + c * size_of(type));
    }
  });
  for (const FileColumn& f : file_columns_) take_bits(f.column, {}, values);
  return values;
}

void ChainValues::apply(const Stage& stage, const Surroundings& around, ColumnBytes& columns) const {
  const std::size_t count = around.ring_end[static_cast<std::size_t>(stage.ring)];
  for (const std::uint16_t column : stage.makes) columns[column].resize(count * columns_[column].bytes());
  std::vector<const std::byte*> pointers;
  const std::vector<PointColumns> slots = slots_of(around, columns, columns_, pointers);
  for (std::size_t s = 0; s * kCellCapacity < count; ++s) {
    stop_if_cancelled();
    const std::size_t first = s * kCellCapacity, size = std::min<std::size_t>(kCellCapacity, count - first);
    std::vector<std::uint32_t> begin;
    for (std::size_t i = first; i <= first + size; ++i)
      begin.push_back(static_cast<std::uint32_t>(around.list_begin[i] - around.list_begin[first]));
    std::vector<std::byte*> made;
    for (const std::uint16_t column : stage.makes)
      made.push_back(columns[column].data() + first * columns_[column].bytes());
    const Neighborhoods in(slots[s], size, slots.data(), begin.data(),
                           around.neighbors.data() + around.list_begin[first], stage.reads, stage.reads_neighbors,
                           stage.position);
    DegeneratePoints degenerate;
    Columns out(made, size, degenerate);
    pointsweep::apply(stage.op, in, out);
  }
}

/// Marks the stages whose values the operator itself computes, because they have no formula. The operator reads exact
/// bits, so the operators that make these bits are applied as well.
void ChainValues::find_applied() {
  const auto apply_maker = [&](std::uint16_t column) {
    if (Stage* const maker = maker_of(column)) maker->applied = true;
  };
  for (std::size_t s = stages_.size(); s-- > 0;) {
    Stage& stage = stages_[s];
    if (stage.cloud) continue;
    stage.applied = stage.applied || !stage.formula;
    if (!stage.applied) continue;
    for (const std::uint16_t column : stage.reads) apply_maker(column);
    for (const std::uint16_t column : stage.reads_neighbors) apply_maker(column);
    if (stage.position >= 0) apply_maker(static_cast<std::uint16_t>(stage.position));
  }
}

bool ChainValues::is_independent(std::size_t a) const {
  const Stage& stage = *maker_of(made_columns_[a]);
  return stage.formula != nullptr || stage.cloud != nullptr;
}

bool ChainValues::is_told(std::size_t a) const { return maker_of(made_columns_[a])->told; }

std::size_t ChainValues::estimates_per_point() const {
  std::size_t count = 0;
  for (const Attribute& a : made_) count += estimates_of(a);
  return count;
}

std::size_t ChainValues::bytes_per_point() const {
  std::size_t bytes = 0;
  for (const Attribute& a : columns_) bytes += a.bytes() + estimates_of(a) * sizeof(Estimate);
  return bytes;
}

/// Returns the part of the list of point i that the rule keeps.
formulas::Kept ChainValues::kept_of(const Surroundings& around, std::size_t i, const ColumnBytes& columns,
                                    const std::vector<PointColumns>& slots) const {
  const std::size_t first = around.list_begin[i], count = around.list_begin[i + 1] - first;
  if (rule_formula_) {
    std::vector<formulas::Place> neighbors;
    for (std::size_t n = first; n < first + count; ++n) neighbors.push_back(place_of(around, around.neighbors[n]));
    std::vector<double> values;
    for (const std::uint16_t c : rule_reads_)
      values.push_back(static_cast<double>(number_in(columns_[c].type, columns[c].data() + i * columns_[c].bytes())));
    return rule_formula_(place_of(around, i), neighbors, values);
  }
  PointColumns own = slots[i / kCellCapacity];
  const std::size_t at = i % kCellCapacity;
  own.x += at, own.y += at, own.z += at, own.row += at;
  std::vector<const std::byte*> values(columns.size(), nullptr);
  for (const std::uint16_t c : rule_reads_) values[c] = columns[c].data() + i * columns_[c].bytes();
  own.columns = values.data();
  const std::uint32_t list[2] = {0, static_cast<std::uint32_t>(count)};
  std::uint32_t kept = 0;
  rule_->choose(Neighborhoods(own, 1, slots.data(), list, around.neighbors.data() + first, rule_reads_, {}),
                {&kept, 1});
  return {kept, true};
}

/// Shortens each list by the rule, before any stage. Returns true for each list whose length depends on rounding.
std::vector<bool> ChainValues::truncate_lists(Surroundings& around, const ColumnBytes& columns) const {
  std::vector<bool> in_doubt(around.list_begin.size() - 1);
  if (!rule_) return in_doubt;
  std::vector<const std::byte*> pointers;
  const std::vector<PointColumns> slots = slots_of(around, columns, columns_, pointers);
  std::vector<std::size_t> begin{0};
  std::vector<std::uint32_t> neighbors;
  for (std::size_t i = 0; i < in_doubt.size(); ++i) {
    stop_if_cancelled();
    const formulas::Kept kept = kept_of(around, i, columns, slots);
    in_doubt[i] = !kept.certain;
    const auto first = around.neighbors.begin() + static_cast<std::ptrdiff_t>(around.list_begin[i]);
    neighbors.insert(neighbors.end(), first, first + static_cast<std::ptrdiff_t>(kept.count));
    begin.push_back(neighbors.size());
  }
  around.list_begin = std::move(begin);
  around.neighbors = std::move(neighbors);
  return in_doubt;
}

/// Converts a column of exact values to estimates without error; open estimates for points in doubt.
void ChainValues::take_bits(std::uint16_t column, const std::vector<bool>& in_doubt, Values& values) const {
  const Attribute& a = columns_[column];
  const std::size_t components = a.fields.size(), count = values.bits[column].size() / a.bytes();
  Estimates& estimates = values.estimates[column];
  estimates.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* value = values.bits[column].data() + i * a.bytes();
    for (std::size_t e = 0; e < estimates_of(a); ++e) {
      const auto number = [&](std::size_t c) {
        return components > 3 ? (c == 0 ? number_in(a.type, value, e) : 0)
                              : (c < components ? number_in(a.type, value, c) : 0);
      };
      const bool unsure = i < in_doubt.size() && in_doubt[i];
      estimates.push_back(unsure ? formulas::open() : Estimate{.value = {number(0), number(1), number(2)}});
    }
  }
}

FormulaInput ChainValues::input_of(const Stage& stage, const Surroundings& around, std::size_t i,
                                   const ColumnEstimates& columns) const {
  FormulaInput in;
  in.place = place_of(around, i);
  for (const std::uint16_t c : stage.reads) in.reads.push_back(columns[c][i]);
  for (const std::uint16_t c : stage.reads_neighbors) {
    std::vector<Estimate>& values = in.of_neighbors.emplace_back();
    for (std::size_t n = around.list_begin[i]; n < around.list_begin[i + 1]; ++n)
      values.push_back(columns[c][around.neighbors[n]]);
  }
  return in;
}

void ChainValues::estimate(const Stage& stage, const Surroundings& around, const std::vector<bool>& in_doubt,
                           ColumnEstimates& columns) const {
  const auto place = [&](std::size_t i) {
    if (stage.position < 0) return place_of(around, i);
    const Estimate& moved = columns[static_cast<std::size_t>(stage.position)][i];
    return formulas::Place{moved.value, moved.error};
  };
  std::vector<formulas::Place> places;
  std::vector<std::uint64_t> rows;
  for (const std::uint16_t c : stage.makes) columns[c].clear();
  for (std::size_t i = 0; i < around.ring_end[static_cast<std::size_t>(stage.ring)]; ++i) {
    stop_if_cancelled();
    places.clear(), rows.clear();
    // For stages that read only the point itself, no values of neighbours have been computed.
    for (std::size_t n = around.list_begin[i]; !stage.alone && n < around.list_begin[i + 1]; ++n)
      places.push_back(place(around.neighbors[n])), rows.push_back(around.row[around.neighbors[n]]);
    FormulaInput in = input_of(stage, around, i, columns);
    in.place = place(i), in.neighbors = places, in.rows = rows;
    const auto is_open = [](const formulas::Place& p) { return !(p.error < formulas::kInfinity); };
    const bool unsure = (in_doubt[i] && !stage.alone) || is_open(in.place) || std::ranges::any_of(places, is_open);
    std::vector<Estimate> made = stage.formula(in);
    if (unsure) std::ranges::fill(made, formulas::open());
    std::size_t next = 0;
    for (const std::uint16_t c : stage.makes)
      for (std::size_t e = 0; e < estimates_of(columns_[c]); ++e) columns[c].push_back(made[next++]);
  }
}

/// Sets the values of a column to its estimates, each rounded to the type of the attribute.
void ChainValues::take_estimates(std::uint16_t column, Values& values) const {
  const Attribute& a = columns_[column];
  const Estimates& estimates = values.estimates[column];
  const std::size_t width = estimates_of(a), count = estimates.size() / width;
  values.bits[column].resize(count * a.bytes());
  for (std::size_t i = 0; i < count; ++i)
    put_estimates(a, estimates.data() + i * width, values.bits[column].data() + i * a.bytes());
}

ChainResults ChainValues::results_of(std::size_t points, const Values& values) const {
  ChainResults results;
  for (std::size_t i = 0; i < points; ++i) {
    for (std::size_t m = 0; m < made_.size(); ++m) {
      const std::uint16_t column = made_columns_[m];
      const std::size_t bytes = columns_[column].bytes(), width = estimates_of(columns_[column]);
      const Estimate* first = values.estimates[column].data() + i * width;
      results.estimates.insert(results.estimates.end(), first, first + width);
      results.values.resize(results.values.size() + bytes);
      std::byte* to = results.values.data() + results.values.size() - bytes;
      if (is_independent(m))
        put_estimates(columns_[column], first, to);
      else
        std::memcpy(to, values.bits[column].data() + i * bytes, bytes);
    }
  }
  return results;
}

void ChainValues::evaluate_local(const Stage& stage, const Surroundings& around, const std::vector<bool>& in_doubt,
                                 Values& values) const {
  if (stage.applied) apply(stage, around, values.bits);
  if (stage.formula) return estimate(stage, around, in_doubt, values.estimates);
  for (const std::uint16_t column : stage.makes)
    take_bits(column, stage.alone ? std::vector<bool>{} : in_doubt, values);
}

ChainResults ChainValues::evaluate(Surroundings around, RowSource& in, CloudRows& rows) const {
  Values values = values_of_input(around, in);
  const std::vector<bool> in_doubt = truncate_lists(around, values.bits);
  for (const Stage& stage : stages_) {
    if (stage.ring < 0) continue;
    if (!stage.cloud) {
      evaluate_local(stage, around, in_doubt, values);
      continue;
    }
    evaluate_cloud(stage, around, rows, values.estimates);
    for (const std::uint16_t column : stage.makes) take_estimates(column, values);
  }
  return results_of(around.ring_end[0], values);
}

}  // namespace pointsweep
