// SPDX-License-Identifier: MIT
#include "pointsweep/verify/chain_values.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "pointsweep/cancellation.h"
#include "pointsweep/error.h"

namespace pointsweep {
namespace {

bool is_kept(const std::vector<std::string>& keep, const std::string& name) {
  return keep.empty() || std::find(keep.begin(), keep.end(), name) != keep.end();
}

/// The points in pieces of kCellCapacity: the number of a point is then the reference to it.
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

ChainValues::ChainValues(std::vector<std::shared_ptr<const Operator>> operators, const std::vector<std::string>& keep,
                         const Schema& input, SharedRule rule)
    : rule_(std::move(rule)) {
  for (const Attribute& a : rule_ ? rule_->reads() : std::vector<Attribute>{}) {
    columns_.push_back(a);
    maker_.push_back(-1);
    rule_reads_.push_back(static_cast<std::uint16_t>(columns_.size() - 1));
    add_file_column(rule_reads_.back(), a, "The rule of neighbourhoods", input);
  }
  int position = -1;
  for (const auto& op : operators) {
    const Contract contract = op->contract();
    Stage stage{
        .op = op, .reads = {}, .reads_neighbors = {}, .makes = {}, .position = position, .alone = contract.alone};
    for (const Attribute& a : contract.reads) stage.reads.push_back(column_of(a, *op, input));
    for (const Attribute& a : contract.reads_neighbors) stage.reads_neighbors.push_back(column_of(a, *op, input));
    for (const Attribute& a : contract.makes) {
      make(a, stage);
      if (a.name == position_attribute().name) position = stage.makes.back();
    }
    stages_.push_back(std::move(stage));
  }
  std::erase_if(made_, [&](const Attribute& a) { return !is_kept(keep, a.name); });
  for (const Attribute& a : made_)
    for (const auto& [name, column] : latest_)
      if (name == a.name) made_columns_.push_back(column);
  find_rings();
}

std::uint16_t ChainValues::new_column(const Attribute& attribute) {
  columns_.push_back(attribute);
  maker_.push_back(-1);
  const auto column = static_cast<std::uint16_t>(columns_.size() - 1);
  const auto known =
      std::find_if(latest_.begin(), latest_.end(), [&](const auto& l) { return l.first == attribute.name; });
  known == latest_.end() ? latest_.emplace_back(attribute.name, column) : * known = {attribute.name, column};
  return column;
}

std::uint16_t ChainValues::column_of(const Attribute& wanted, const Operator& op, const Schema& input) {
  for (const auto& [name, column] : latest_)
    if (name == wanted.name) return column;
  const std::uint16_t column = new_column(wanted);
  add_file_column(column, wanted, op.name(), input);
  return column;
}

void ChainValues::add_file_column(std::uint16_t column, const Attribute& wanted, const std::string& who,
                                  const Schema& input) {
  std::vector<Field> fields;
  for (const std::string& name : wanted.fields) {
    const auto at = input.find(name);
    if (!at) fail_usage("{}: needs '{}', which neither the input nor an earlier stage has.", who, wanted.name);
    fields.push_back(input.fields[*at]);
  }
  file_columns_.push_back({column, wanted, std::move(fields)});
}

void ChainValues::make(const Attribute& attribute, Stage& stage) {
  stage.makes.push_back(new_column(attribute));
  maker_.back() = static_cast<int>(stages_.size());
  const auto known =
      std::find_if(made_.begin(), made_.end(), [&](const Attribute& a) { return a.name == attribute.name; });
  known == made_.end() ? made_.push_back(attribute) : void(*known = attribute);
}

/// From the last stage back: who looks at neighbours needs what he reads one ring farther out.
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
  if (maker_[column] < 0) return;
  int& known = stages_[static_cast<std::size_t>(maker_[column])].ring;
  known = std::max(known, ring);
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

void ChainValues::fetch_file_columns(const Surroundings& around, RowSource& in, ColumnBytes& columns) const {
  if (file_columns_.empty()) return;
  std::vector<std::size_t> order(around.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return around.row[a] < around.row[b]; });
  std::vector<std::uint64_t> rows;
  for (const std::size_t i : order) rows.push_back(around.row[i]);
  for (const FileColumn& f : file_columns_) columns[f.column].resize(around.size() * f.attribute.bytes());
  for_each_record(in, rows, [&](std::size_t r, const std::byte* record) {
    for (const FileColumn& f : file_columns_) {
      Field to;
      to.type = f.attribute.type;
      std::byte* value = columns[f.column].data() + order[r] * f.attribute.bytes();
      for (std::size_t c = 0; c < f.fields.size(); ++c)
        set_value(to, value, value_of(f.fields[c], record), static_cast<std::uint32_t>(c));
    }
  });
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
    Columns out(made, size);
    stage.op->apply(in, out);
  }
}

/// Leaves of each list what the rule keeps, before any stage.
void ChainValues::shorten(Surroundings& around, const ColumnBytes& columns) const {
  std::vector<const std::byte*> pointers;
  const std::vector<PointColumns> slots = slots_of(around, columns, columns_, pointers);
  const std::vector<std::size_t> from = around.list_begin;
  std::size_t end = 0;
  for (std::size_t i = 0; i + 1 < from.size(); ++i) {
    stop_if_cancelled();
    PointColumns own = slots[i / kCellCapacity];
    const std::size_t at = i % kCellCapacity;
    own.x += at, own.y += at, own.z += at, own.row += at;
    std::vector<const std::byte*> values(columns.size(), nullptr);
    for (const std::uint16_t c : rule_reads_) values[c] = columns[c].data() + i * columns_[c].bytes();
    own.columns = values.data();
    const std::uint32_t list[2] = {0, static_cast<std::uint32_t>(from[i + 1] - from[i])};
    std::uint32_t kept = 0;
    rule_->choose(Neighborhoods(own, 1, slots.data(), list, around.neighbors.data() + from[i], rule_reads_, {}),
                  {&kept, 1});
    std::copy_n(around.neighbors.data() + from[i], kept, around.neighbors.data() + end);
    around.list_begin[i] = end;
    end += kept;
  }
  around.list_begin.back() = end;
  around.neighbors.resize(end);
}

std::vector<std::byte> ChainValues::evaluate(Surroundings around, RowSource& in) const {
  ColumnBytes columns(columns_.size());
  fetch_file_columns(around, in, columns);
  if (rule_) shorten(around, columns);
  for (const Stage& stage : stages_)
    if (stage.ring >= 0) apply(stage, around, columns);
  const std::size_t chosen = around.ring_end[0], stride = result_bytes();
  std::vector<std::byte> results(chosen * stride);
  std::size_t offset = 0;
  for (const std::uint16_t column : made_columns_) {
    const std::size_t bytes = columns_[column].bytes();
    for (std::size_t i = 0; i < chosen; ++i)
      std::memcpy(results.data() + i * stride + offset, columns[column].data() + i * bytes, bytes);
    offset += bytes;
  }
  return results;
}

}  // namespace pointsweep
