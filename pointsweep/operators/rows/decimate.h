// SPDX-License-Identifier: MIT
/// Keeping a share of the points, chosen by a hash of their coordinates.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "pointsweep/operator.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration decimate_declaration();

/// Keeps a point if the hash of its coordinates, as a fraction of all hashes, is below `share`. The choice does not
/// depend on other points: tiles give the same points as the merged cloud, in any order. Points of equal coordinates
/// stay together or go together. Points without a finite place all stay.
class Decimate final : public SelectOperator {
 public:
  /// `share`: in [0, 1]; `seed`: another one chooses other points, independently. Throws UsageError.
  explicit Decimate(double share, std::uint64_t seed = 0);
  std::string name() const override { return "decimate"; }
  void keep(const Neighborhoods& points, std::span<std::uint8_t> kept) const override;

 protected:
  Options own_options() const override { return {{"share", share_}, {"seed", seed_}}; }

 private:
  double share_;
  std::uint64_t seed_;
};

}  // namespace pointsweep
