// SPDX-License-Identifier: MIT
/// Which points are ground, by a filter of the raster of the lowest points (T. J. Pingel, K. C. Clarke and W. A.
/// McBride, "An improved simple morphological filter for the terrain classification of airborne LIDAR data", ISPRS
/// Journal of Photogrammetry and Remote Sensing 77, 2013).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/operators.h"
#include "pointsweep/operators/ordered_operator.h"
#include "pointsweep/raster/ground_surface.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration ground_declaration();

/// N u8, classes of LAS: 2 ground, 1 unclassified.
Attribute classification_attribute();

/// Makes classification: 2 for ground; the class of the input, or of an earlier stage, for other points, but 1 in the
/// place of 2, and 1 where there is none. Only points that take part can be ground: last returns without the classes 7
/// and 18 (noise), unless the options ask for others; attributes that the cloud does not have rule nothing out.
class Ground final : public OrderedOperator {
 public:
  /// Throws UsageError for options that are no numbers in their ranges.
  explicit Ground(const GroundOptions& options = {});
  std::string name() const override { return "ground"; }
  Contract contract() const override;
  std::shared_ptr<const Operator> bound(const Schema& input, std::span<const Attribute> made) const override;
  Vec3 place_of(Vec3 position) const override;
  bool in_plane() const override { return true; }
  std::unique_ptr<OrderedWork> work(const OrderedSetup& setup) const override;
  std::uint64_t least_bytes(std::span<const Vec3> sample, int axis) const override;
  const GroundOptions& options() const { return options_; }
  GroundRule rule() const;

  /// Where in the values of a point an attribute is; absent: the cloud does not have it.
  struct Places {
    std::optional<std::size_t> return_number, number_of_returns, classification;
  };

 protected:
  Options own_options() const override;

 private:
  GroundOptions options_;
  std::vector<Attribute> reads_;
  Places places_;
};

}  // namespace pointsweep
