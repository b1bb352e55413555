// SPDX-License-Identifier: MIT
/// Levels of detail as an attribute.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "pointsweep/in_order_operator.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration level_declaration();

/// Makes "level", the depth at which a point is first drawn (levels/level_choice.h). Positions are rounded to steps of
/// 2^-30 of the widest extent, so that the levels equal those of a cloud stored on such a grid.
class Level final : public InOrderOperator {
 public:
  Level();
  std::string name() const override { return "level"; }
  InOrderContract in_order_contract() const override;
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override;
  std::uint64_t least_bytes(const CloudEstimate& cloud) const override;
};

}  // namespace pointsweep
