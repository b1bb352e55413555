// SPDX-License-Identifier: MIT
/// `denoise`: drops statistical outliers.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operators.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration denoise_declaration();

/// A composite of sor, a condition that drops outliers, and a drop of the attributes that sor makes.
class Denoise final : public CompositeOperator {
 public:
  explicit Denoise(const SorOptions& options);
  std::string name() const override { return "denoise"; }
  Contract contract() const override { return {.makes = {selection_attribute()}}; }
  std::vector<ChainStage> parts() const override;

 private:
  SorOptions options_;
};

}  // namespace pointsweep
