// SPDX-License-Identifier: MIT
/// The comparison of a made attribute in an output with the estimate of its formula.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/verify/formulas/estimate.h"
#include "pointsweep/verify/rows/field_pair.h"

namespace pointsweep {

/// The components of an attribute, one to three, that share one estimate, and their places in the output.
class MadeValue {
 public:
  /// `pairs`: from a result record to a record of the output, one for each component; none for one not written.
  explicit MadeValue(std::vector<std::optional<FieldPair>> pairs) : pairs_(std::move(pairs)) {}

  /// The first wrong component; nothing if the value is right. Estimates without error are compared as FieldPair does,
  /// bit for bit where types are alike; others must not differ by more than their error and one rounding to the type
  /// of the output.
  std::optional<std::size_t> wrong_component(const formulas::Estimate& estimate, const std::byte* result,
                                             const std::byte* record) const;
  /// "nx is 0.3, but 0.2 by brute force, give or take 1e-07".
  std::string difference(std::size_t component, const formulas::Estimate& estimate, const std::byte* result,
                         const std::byte* record) const;

  /// Returns how far the value in the output is from the nearest right one, beyond what its type rounds; 0 is exact.
  formulas::Real distance(const formulas::Estimate& estimate, const std::byte* record) const;

 private:
  formulas::Real distance_to(formulas::Vector expected, const std::byte* record) const;

  std::vector<std::optional<FieldPair>> pairs_;
};

}  // namespace pointsweep
