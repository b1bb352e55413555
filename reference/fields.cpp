// SPDX-License-Identifier: MIT
#include "reference/fields.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <set>

namespace pointsweep::reference {
namespace {

constexpr std::size_t kAlignment = alignof(std::max_align_t);
constexpr std::size_t kPositionBytes = 3 * sizeof(double);

bool is_position(const Attribute& attribute) { return attribute.name == position_attribute().name; }
Field position_field() { return {.offset = 0, .bytes = kPositionBytes, .is_position = true}; }

}  // namespace

Fields::Fields(const Schema& record, const SharedRule& rule, const std::vector<StageOperator>& chain,
               const std::vector<Attribute>& kept)
    : record_(record), bytes_(record.stride) {
  for (const Attribute& a : rule ? rule->reads() : std::vector<Attribute>{}) rule_reads_.push_back(add_from_file(a));
  latest_[position_attribute().name] = position_field();
  for (const auto& op : chain) stages_.push_back(plan(op));
  plan_copies();
  for (const Attribute& attribute : kept) kept_.push_back(latest_.at(attribute.name));
}

Field Fields::add(std::size_t bytes) {
  bytes_ = (bytes_ + kAlignment - 1) / kAlignment * kAlignment;
  const Field field{.offset = bytes_, .bytes = bytes};
  bytes_ += bytes;
  return field;
}

Stage Fields::plan(const StageOperator& op) {
  const Contract contract = contract_of(op);
  Stage stage;
  stage.op = op;
  stage.neighbor_position = position_field();
  stage.moved = !stages_.empty() && (stages_.back().moved || stages_.back().moves);
  for (const Attribute& a : contract.reads) stage.reads.push_back(find(a));
  for (const Attribute& a : contract.reads_neighbors) stage.reads_neighbors.push_back(find(a));
  for (const Attribute& a : contract.makes) {
    const auto known = latest_.find(a.name);
    if (known == latest_.end() || known->second.bytes != a.bytes()) latest_[a.name] = add(a.bytes());
    stage.makes.push_back(latest_.at(a.name));
    stage.moves |= is_position(a);
  }
  stage.waits = stage.moves || !contract.reads_neighbors.empty();
  return stage;
}

Field Fields::find(const Attribute& attribute) {
  const auto known = latest_.find(attribute.name);
  return known != latest_.end() ? known->second : latest_[attribute.name] = add_from_file(attribute);
}

Field Fields::add_from_file(const Attribute& attribute) {
  FileAttribute file{add(attribute.bytes()), attribute.type, {}};
  for (const std::string& name : attribute.fields) {
    const auto index = record_.find(name);
    assert(index && "the chain was checked against the input");
    file.from.emplace_back(record_.fields[*index], attribute.type);
  }
  file_.push_back(file);
  return file.to;
}

/// A waiting operator reads neighbours that later operators may already have processed. So each field that this
/// operator reads of neighbours and that this or a later operator overwrites is copied when a point enters the buffer.
/// Positions are copied only for an operator that moves points: it waits for all points in earlier buffers that refer
/// to a point (smallest_reference()), but not for the points in its own buffer.
void Fields::plan_copies() {
  std::set<std::size_t> overwritten;  // offsets of the fields that this stage or a later one makes
  for (auto stage = stages_.rbegin(); stage != stages_.rend(); ++stage) {
    for (const Field& made : stage->makes)
      if (!made.is_position) overwritten.insert(made.offset);
    const auto copied = [&](Field& field) {
      stage->copies.push_back({field, add(field.bytes)});
      field = stage->copies.back().to;
    };
    for (Field& field : stage->reads_neighbors)
      if (field.is_position ? stage->moves : overwritten.contains(field.offset)) copied(field);
    if (stage->moves) copied(stage->neighbor_position);
  }
}

void Fields::fill(StreamPoint& point, const std::byte* record, FirstRowError& refused) const {
  point.fields = std::make_unique<std::byte[]>(bytes_);
  std::memcpy(point.fields.get(), record, record_.stride);
  for (const FileAttribute& file : file_) {
    std::byte* to = file.to.in(point);
    for (const PromisedType& from : file.from) {
      from.convert(record, point.row, to, refused);
      to += size_of(file.type);
    }
  }
}

void Fields::result(StreamPoint& point, std::vector<std::byte>& out) const {
  out.clear();
  for (const Field& field : kept_) out.insert(out.end(), field.in(point), field.in(point) + field.bytes);
}

}  // namespace pointsweep::reference
