// SPDX-License-Identifier: MIT
/// Conversion of a field of records to the type that the plan has promised to a stage.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pointsweep/points/schema.h"
#include "pointsweep/row_error.h"

namespace pointsweep {

/// Converts a field of records to `type`.
class PromisedType {
 public:
  PromisedType(Field stored, Type type);

  /// Writes the converted value of `record`, which has the row `row`, to `out`. Notes in `refused` a value that the
  /// type cannot hold.
  void convert(const std::byte* record, std::uint64_t row, std::byte* out, FirstRowError& refused) const;

 private:
  Field stored_, promised_;
  std::size_t bytes_;
  bool is_copy_, holds_all_;
};

}  // namespace pointsweep
