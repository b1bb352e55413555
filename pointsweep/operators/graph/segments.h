// SPDX-License-Identifier: MIT
/// Segments: parts of a surface across which normals turn little from neighbour to neighbour. Segments resemble the
/// regions of region growing, but do not depend on seeds or their order (T. Rabbani, F. van den Heuvel, G. Vosselman,
/// "Segmentation of point clouds using smoothness constraint", 2006).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operators.h"
#include "pointsweep/operators/graph/plane_residual.h"
#include "pointsweep/operators/kinds/connect_operator.h"

namespace pointsweep {

/// Makes segment, segment_size and segment_residual: components of the points that are joined if one is a neighbour of
/// the other, their normals differ by less than an angle, whatever their signs, and their distance is within a limit. A
/// point without a normal is a segment of one point. PlaneResidual measures how flat segments are.
class Segments final : public ConnectOperator {
 public:
  /// Throws UsageError for options out of their ranges. `points`: points of the cloud for has_short_numbers().
  explicit Segments(const SegmentsOptions& options = {}, std::uint64_t points = 0);
  std::string name() const override { return "segments"; }
  Contract contract() const override;
  const VoteRule* votes() const override { return &residual_; }
  /// Returns an operator that computes the residual from the moved points, if an earlier stage moves points; else null.
  std::shared_ptr<const ConnectOperator> bound(const Schema& input, std::span<const Attribute> made) const override;
  void connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte* ballots) const override;
  void put_values(const ComponentLabel& label, std::byte* values) const override;

 private:
  SegmentsOptions options_;
  std::uint64_t points_;
  PlaneResidual residual_{false};
};

}  // namespace pointsweep
