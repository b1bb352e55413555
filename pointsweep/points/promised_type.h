// SPDX-License-Identifier: MIT
/// Conversion of a field of the input to the type with which a stage declares this attribute (Contract::reads).
#pragma once

#include <cstddef>
#include <cstdint>

#include "pointsweep/points/schema.h"
#include "pointsweep/row_error.h"

namespace pointsweep {

/// Converts the first value of the field `stored` of records to `type`.
class PromisedType {
 public:
  PromisedType(Field stored, Type type);

  /// Writes the converted value of `record`, which has the row `row`, to `out`: rounded and saturated if the type is an
  /// integer. Notes an error in `refused` if the value is out of the range of the type.
  void convert(const std::byte* record, std::uint64_t row, std::byte* out, FirstRowError& refused) const;

 private:
  Field stored_, promised_;
  std::size_t bytes_;
  bool is_copy_;    ///< true if `stored` has the promised type without scale, bias and bits: the bytes are copied
  bool holds_all_;  ///< true if the promised type has room for all values of `stored`: no value is checked
};

}  // namespace pointsweep
