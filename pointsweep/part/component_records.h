// SPDX-License-Identifier: MIT
/// The records that tiles leave of their components, and those of the components of the cloud.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "pointsweep/connect/forest_log.h"
#include "pointsweep/connect/vote_rule.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {

inline constexpr std::uint64_t kNoLabel = ~std::uint64_t{0};
inline constexpr Encoding kSegmentsEncoding{"joined components of a tile", 1};
inline constexpr std::size_t kLabelsAtOnce = 4096;

/// Votes that are not concluded, so that components can be joined. No sign is turned in a graph without weights.
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

  /// Of the rule itself.
  std::size_t concluded_bytes() const { return rule_ != nullptr ? rule_->result_bytes() : 0; }
  /// Sets the result, and returns whether the component gets a number.
  bool conclude_to(const std::byte* votes, std::byte* result) const {
    if (rule_ == nullptr) return true;
    rule_->conclude(votes, result);
    return rule_->counts(result);
  }

 private:
  const VoteRule* rule_;
};

/// A component of a tile, as bytes: a FinishedComponent, then its votes.
inline constexpr std::size_t kComponentBytes = sizeof(PointKey) + sizeof(std::uint64_t);

inline FinishedComponent component_at(const std::byte* record) {
  FinishedComponent component;
  std::memcpy(&component.first, record, sizeof component.first);
  std::memcpy(&component.points, record + sizeof component.first, sizeof component.points);
  return component;
}

/// A component of the cloud as each of its tiles knows it, as bytes: its number and points, then the result of its
/// votes.
inline constexpr std::size_t kNumberedBytes = 2 * sizeof(std::uint64_t);

inline void put_number(std::byte* record, std::uint64_t number, std::uint64_t points) {
  std::memcpy(record, &number, sizeof number);
  std::memcpy(record + sizeof number, &points, sizeof points);
}

/// Records of KEY.numbers that follow each other, of components of one tile.
struct Segment {
  std::uint64_t first, count;
};

}  // namespace pointsweep
