// SPDX-License-Identifier: MIT
/// The header of a NumPy array (format versions 1 to 3).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/points/schema.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

struct NpyHeader {
  Schema item;  ///< an element: one field without a name, or the fields of a structured type
  bool is_structured = false;
  std::vector<Field> big_endian;  ///< fields of `item` with big-endian values
  std::string description;        ///< type in the file's notation, e.g. "<f4", or "a structured type"
  bool fortran_order = false;
  std::vector<std::uint64_t> shape;
  std::uint64_t data = 0;  ///< byte of the first element

  /// Returns the product of the sizes of all axes except the last `without` ones.
  std::uint64_t elements(std::size_t without = 0) const;
};

/// Reads the header of the array that begins at byte `begin` and ends before `end`; `what` names the array in errors.
/// Throws Error for a damaged header, for a type that no attribute can have, and if the array has more or fewer bytes
/// than its header states.
NpyHeader read_npy_header(const InputFile& file, std::uint64_t begin, std::uint64_t end, const std::string& what);

}  // namespace pointsweep
