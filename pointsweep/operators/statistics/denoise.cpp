// SPDX-License-Identifier: MIT
/// `denoise`: drops statistical outliers.
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/statistics/outliers.h"

namespace pointsweep {
namespace {

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

}  // namespace

OperatorDeclaration denoise_declaration() {
  return {.name = "denoise",
          .meaning = "leaves out statistical outliers: sor, without the attributes that it makes",
          .options = sor_options().declarations(),
          .make = sor_options().maker<Denoise>(),
          .formula = "sor | where(outlier == 0) | drop(mean_distance, outlier)",
          .source = "that of sor",
          .undefined =
              "Without neighbours, or if one has no finite place, a point is left out. Attributes mean_distance and "
              "outlier of the input are refused.",
          .cost = "that of sor",
          .example = "knn(k=8) | denoise(multiplier=2)"};
}

ChainStage operators::denoise(const SorOptions& options) { return std::make_shared<Denoise>(options); }

Denoise::Denoise(const SorOptions& options) : options_(options) { sor_options().declare(*this, options); }

std::vector<ChainStage> Denoise::parts() const {
  return {std::make_shared<MeanDistance>(options_), std::make_shared<Outlier>(options_),
          operators::where("outlier == 0"), Drop{{mean_distance_attribute().name, outlier_attribute().name}}};
}

}  // namespace pointsweep
