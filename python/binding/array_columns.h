// SPDX-License-Identifier: MIT
/// Arrays of Python as columns of a cloud, without a copy.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/attribute.h"

namespace pointsweep {

/// An N×m array, borrowed until the last copy of this object is destroyed. Any thread may destroy it.
struct ArrayColumn {
  std::vector<std::string> names;  ///< names of the m values of a row
  Type type = Type::f64;
  const std::byte* first = nullptr;
  std::ptrdiff_t row_stride = 0;    ///< bytes from row to row; may be negative
  std::ptrdiff_t value_stride = 0;  ///< bytes from value to value of one row
  std::size_t rows = 0;
  std::shared_ptr<const void> owner;
};

/// Returns a column that holds the buffer of `array`: N×names.size() numbers in the byte order of the machine. Throws
/// UsageError for another shape and for values that are not booleans, integers of at most 64 bits, float32 or float64;
/// Python's exception if the object has no such buffer.
ArrayColumn borrow_array(nanobind::handle array, std::vector<std::string> names);

/// An array to be written: value v of row i is at `first` + (i * values + v) * size_of(type).
struct WritableArray {
  Type type = Type::f64;
  std::byte* first = nullptr;
  std::size_t rows = 0, values = 0;
  std::shared_ptr<const void> owner;
};

/// Returns an array that holds the buffer of `array`, N×m contiguous numbers. Throws like borrow_array(), and Python's
/// exception if `array` is read-only or not contiguous.
WritableArray borrow_writable(nanobind::handle array, const std::string& name);

}  // namespace pointsweep
