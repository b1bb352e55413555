// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/shorten.h"

#include <algorithm>

namespace pointsweep {
namespace {

/// A query as a rule sees it: one point in a slot of its own, its neighbours in as many slots as they fill.
class QueryView {
 public:
  QueryView(const SweepPlan& plan, const StreamQuery& query) : columns_(plan.column_bytes.size(), nullptr) {
    const auto* bytes = reinterpret_cast<const std::byte*>(query.file_columns.data());
    for (const FileColumn& file : plan.file_columns) {
      columns_[file.column] = bytes;
      bytes += plan.column_bytes[file.column];
    }
    add(query.position, query.row);
    for (const Candidate& c : query.neighbors) add(c.position, c.row);
    for (std::size_t first = 0; first < row_.size(); first += kCellCapacity)
      slots_.push_back({&x_[first], &y_[first], &z_[first], &row_[first], columns_.data()});
    lists_.begin = {0, static_cast<std::uint32_t>(query.neighbors.size())};
    for (std::uint32_t i = 1; i < row_.size(); ++i)
      lists_.refs.push_back(make_ref(i / kCellCapacity, i % kCellCapacity));
  }

  /// How many neighbours the rule keeps.
  std::size_t shortened(const SweepPlan& plan) {
    shorten(plan, slots_.front(), 1, slots_.data(), lists_);
    return lists_.begin.back();
  }

 private:
  void add(Vec3 position, std::uint64_t row) {
    x_.push_back(position.x), y_.push_back(position.y), z_.push_back(position.z), row_.push_back(row);
  }

  std::vector<const std::byte*> columns_;
  std::vector<double> x_, y_, z_;
  std::vector<std::uint64_t> row_;
  std::vector<PointColumns> slots_;
  CellNeighbors lists_;
};

}  // namespace

void shorten(const SweepPlan& plan, const PointColumns& own, std::size_t size, const PointColumns* slots,
             CellNeighbors& lists) {
  if (!plan.neighborhood.rule) return;
  std::vector<std::uint32_t> counts(size);
  plan.neighborhood.rule->choose(
      Neighborhoods(own, size, slots, lists.begin.data(), lists.refs.data(), plan.rule_reads, {}), counts);
  std::uint32_t end = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::uint32_t from = lists.begin[i], kept = std::min(counts[i], lists.begin[i + 1] - from);
    const auto first = lists.refs.begin() + from;
    std::copy(first, first + kept, lists.refs.begin() + end);
    lists.begin[i] = end;
    end += kept;
  }
  lists.begin[size] = end;
  lists.refs.resize(end);
}

void shorten(const SweepPlan& plan, StreamQuery& query) {
  if (!plan.neighborhood.rule) return;
  const std::size_t kept = QueryView(plan, query).shortened(plan);
  query.neighbors.resize(kept);
  if (!query.neighbor_columns.empty()) query.neighbor_columns.resize(kept);
}

}  // namespace pointsweep
