// SPDX-License-Identifier: MIT
/// Keeping a share of the points, chosen by a hash of their coordinates.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

/// Keeps a point if the hash of its coordinates, as a fraction of all hashes, is below `share`. The choice does not
/// depend on other points: tiles give the same points as the merged cloud, in any order. Of points with equal
/// coordinates, all or none are kept. Points without a finite place are all kept.
class Decimate final : public SelectOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit Decimate(const DecimateOptions& options);
  std::string name() const override { return "decimate"; }
  void keep(const Neighborhoods& points, std::span<std::uint8_t> kept) const override;

 private:
  DecimateOptions options_;
};

}  // namespace pointsweep
