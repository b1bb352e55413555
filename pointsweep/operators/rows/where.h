// SPDX-License-Identifier: MIT
/// Keeping the points for which a condition holds.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators/expressions/expression.h"
#include "pointsweep/operators/expressions/named_values.h"

namespace pointsweep {

/// Keeps the rows for which `condition` holds, e.g. classification == 2 && z < 100. Points without a finite place are
/// tested like all others: x, y or z is then NaN or infinite, and made attributes have the documented value for
/// undefined results.
class Where final : public SelectOperator {
 public:
  /// Messages begin with `place`, e.g. "pipeline, column 12: where". Throws UsageError for a text that is no condition.
  explicit Where(std::string_view condition, std::string place = "where");
  std::string name() const override { return "where"; }
  std::vector<Attribute> reads() const override { return names_.reads(); }
  void keep(const Neighborhoods& points, std::span<std::uint8_t> kept) const override;
  /// Throws UsageError for an unknown name, with the known names.
  std::shared_ptr<const SelectOperator> bound(const Schema& input, std::span<const Attribute> made) const override;

 private:
  Expression condition_;
  std::string place_;
  NamedValues names_;  ///< empty before bound()
};

}  // namespace pointsweep
