// SPDX-License-Identifier: MIT
/// Changes between two clouds along normals: multiscale model to model cloud comparison.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration m3c2_declaration();

/// Compares two clouds by M3C2: D. Lague, N. Brodu and J. Leroux, "Accurate 3D comparison of complex topography with
/// terrestrial laser scanner" (ISPRS Journal of Photogrammetry and Remote Sensing 82, 2013), Section 3, with every
/// point as a core point and the normals of an earlier stage or of the input.
class M3c2 final : public InOrderOperator {
 public:
  /// Throws UsageError for options outside of their ranges.
  explicit M3c2(M3c2Options options);

  std::string name() const override { return "m3c2"; }
  InOrderContract in_order_contract() const override;
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override;
  std::optional<Reach> reach() const override;
  std::optional<Reach> other_reach() const override { return reach(); }
  std::string other_cloud() const override { return options_.cloud; }
  std::uint64_t least_bytes(const CloudEstimate& cloud) const override;

 private:
  M3c2Options options_;
};

}  // namespace pointsweep
