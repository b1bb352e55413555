// SPDX-License-Identifier: MIT
/// Two kinds of records: a tile's record of each of its components, and the record of each component of the whole
/// cloud.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "pointsweep/connect/forest_log.h"
#include "pointsweep/connect/vote_rule.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/part/tile_graph.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {

/// The label of a row without a component.
inline constexpr std::uint64_t kNoLabel = ~std::uint64_t{0};
inline constexpr Encoding kSegmentsEncoding{"joined components of a tile", 1};

/// Returns a store with kNoLabel for each row of a tile.
inline RowStore store_of_labels(std::uint64_t rows, const TileGraphSetup& setup) {
  const std::vector<std::byte> none(sizeof kNoLabel, std::byte{0xff});
  return {rows, none, setup.spill, std::max<std::uint64_t>(setup.memory_bytes / 4, 1 << 20)};
}

/// A vote rule that sums the votes of another rule without concluding them, so that components of several tiles can be
/// joined later. If the other rule is null, there are no votes. turns() is not forwarded, because edges without weights
/// flip no signs.
class OpenVotes final : public VoteRule {
 public:
  explicit OpenVotes(const VoteRule* rule) : rule_(rule) {}
  std::size_t ballot_bytes() const override { return rule_ != nullptr ? rule_->ballot_bytes() : 0; }
  std::size_t bytes() const override { return rule_ != nullptr ? rule_->bytes() : 0; }
  void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const override {
    if (rule_ != nullptr) rule_->start(votes, point, ballot);
  }
  void merge(std::byte* into, const std::byte* from, bool flips) const override {
    if (rule_ != nullptr) rule_->merge(into, from, flips);
  }
  std::size_t result_bytes() const override { return bytes(); }
  void conclude(const std::byte* votes, std::byte* result) const override { std::copy_n(votes, bytes(), result); }

  /// Returns the size in bytes of the result that conclude_to() makes; 0 without a rule.
  std::size_t concluded_bytes() const { return rule_ != nullptr ? rule_->result_bytes() : 0; }
  /// Concludes votes into `result`, and returns whether the component gets a number.
  bool conclude_to(const std::byte* votes, std::byte* result) const {
    if (rule_ == nullptr) return true;
    rule_->conclude(votes, result);
    return rule_->counts(result);
  }

 private:
  const VoteRule* rule_;
};

/// Bytes of the record of a tile's component, a FinishedComponent, without the votes that follow it.
inline constexpr std::size_t kComponentBytes = sizeof(PointKey) + sizeof(std::uint64_t);

inline FinishedComponent component_at(const std::byte* record) {
  FinishedComponent component;
  std::memcpy(&component.first, record, sizeof component.first);
  std::memcpy(&component.points, record + sizeof component.first, sizeof component.points);
  return component;
}

/// Bytes of the record of a component of the whole cloud: its number and its count of points. The result of its votes
/// follows and is not counted.
inline constexpr std::size_t kNumberedBytes = 2 * sizeof(std::uint64_t);

inline void put_number(std::byte* record, std::uint64_t number, std::uint64_t points) {
  std::memcpy(record, &number, sizeof number);
  std::memcpy(record + sizeof number, &points, sizeof points);
}

/// Successive records of the list KEY.numbers (join_graphs() in tile_graph.h) that belong to components of one tile.
struct Segment {
  std::uint64_t first, count;
};

}  // namespace pointsweep
