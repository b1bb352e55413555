// SPDX-License-Identifier: MIT
/// Results of operators: attributes that are NaN where a row has no result, and findings about many rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "pointsweep/in_order_operator.h"

namespace pointsweep {

/// Makes a scalar attribute of a floating-point type that is NaN in rows without a result (Attribute::fill).
inline Attribute nan_scalar(std::string name, std::string unit, std::string meaning, Type type = Type::f64) {
  Attribute a = scalar(std::move(name), type, std::move(unit), std::move(meaning));
  a.fill = std::byte{0xff};
  return a;
}

/// Adds the made values of `rows`, row after row, to the findings.
inline void add_findings(std::span<const std::uint64_t> rows, std::span<const std::byte> values, Findings& findings) {
  findings.rows.insert(findings.rows.end(), rows.begin(), rows.end());
  findings.values.insert(findings.values.end(), values.begin(), values.end());
}

}  // namespace pointsweep
