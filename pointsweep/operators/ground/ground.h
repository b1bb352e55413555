// SPDX-License-Identifier: MIT
/// Ground points, found by a filter of the raster of the lowest points (T. J. Pingel, K. C. Clarke and W. A. McBride,
/// "An improved simple morphological filter for the terrain classification of airborne LIDAR data", ISPRS Journal of
/// Photogrammetry and Remote Sensing 77, 2013).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/raster/ground_surface.h"

namespace pointsweep {

/// Returns classification, N u8, classes of LAS: 2 ground, 1 unclassified.
Attribute classification_attribute();

/// Makes classification: 2 for ground. Other points keep the class of the input or of an earlier stage, except that
/// class 2 and a missing class become 1. Only points that take part can be ground: last returns whose class is neither
/// 7 nor 18 (noise). Options admit all returns, or noise. Attributes that the cloud lacks exclude no point.
class Ground final : public InOrderOperator {
 public:
  /// Throws UsageError for options outside of their ranges.
  explicit Ground(const GroundOptions& options = {});
  std::string name() const override { return "ground"; }
  InOrderContract in_order_contract() const override;
  std::shared_ptr<const InOrderOperator> bound(const Schema& input, std::span<const Attribute> made) const override;
  Vec3 place_of(Vec3 position) const override;
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override;
  std::optional<Reach> reach() const override;
  ChoosePoints for_other_parts() const override;
  std::uint64_t least_bytes(const CloudEstimate& cloud) const override;
  InOrderEffort effort(const CloudEstimate& cloud) const override;

  /// Indices of attributes in the values of a point; nullopt for an attribute that the cloud lacks or the options
  /// ignore.
  struct ValueNumbers {
    std::optional<std::size_t> return_number, number_of_returns, classification;
  };

 private:
  GroundRule rule() const;

  GroundOptions options_;
  std::vector<Attribute> reads_;
  ValueNumbers numbers_;
};

}  // namespace pointsweep
