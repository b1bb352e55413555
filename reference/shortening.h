// SPDX-License-Identifier: MIT
/// Neighbourhoods whose size differs from point to point (points/neighborhood_rule.h). The paper leaves them open:
/// "k or d ... could as well be derived for each point" (Section 4.1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "reference/fields.h"

namespace pointsweep::reference {

/// A point as the rule sees it: apart from the active set, so that it may have left.
struct RuledPoint {
  Vec3 position;
  std::uint64_t row;
  std::vector<std::byte> attributes;  ///< attributes that the rule reads, one after another
};

/// Says how many of the neighbours found the rule of the task keeps; without a rule, all of them.
class Shortening {
 public:
  Shortening(SharedRule rule, const Fields& fields) : rule_(std::move(rule)), reads_(fields.rule_reads()) {}

  explicit operator bool() const { return static_cast<bool>(rule_); }
  RuledPoint ruled(StreamPoint& point) const;
  /// `nearest_first`: neighbours of the point.
  std::size_t kept(const RuledPoint& point, std::span<const Rank> nearest_first);
  /// Leaves N_i of the neighbours found. Only after NearestSet::sort().
  void shorten(StreamPoint& point);

 private:
  SharedRule rule_;
  std::vector<Field> reads_;
  std::vector<double> x_, y_, z_;  ///< neighbours in columns
  std::vector<std::uint64_t> row_;
  std::vector<NeighborRef> refs_;
  std::vector<PointColumns> slots_;
};

/// The neighbours found, apart from the active set.
std::vector<Rank> ranks_of(std::span<const Neighbor> neighbors);

}  // namespace pointsweep::reference
