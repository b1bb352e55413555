// SPDX-License-Identifier: MIT
/// NumPy arrays: the header of an array (format versions 1 to 3), readers of neighbours and distances as rows, and of
/// points in .npy files and .npz archives, and a writer of arrays.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/input_file.h"
#include "pointsweep/writer.h"

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

/// Opens a little-endian, C-ordered array of one or two dimensions (format versions 1 to 3). The schema has one field
/// for each column: neighbor_0, ... for uint32 and uint64, distance_0, ... for float64. Throws Error for other arrays.
std::unique_ptr<Reader> open_npy(const std::filesystem::path& path);

/// Creates a writer of an array. The schema of the plan must have one plain field. The array has shape (n, count), or
/// (n,) if the count is 1 and the attribute in OutputPlan::made is not a list, in C order and little-endian.
/// numpy.load(path, mmap_mode="r") opens an array of any size.
std::unique_ptr<Writer> create_npy_writer(const OutputPlan& plan);

/// Opens an array of n rows and three columns or more (x, y, z, then the names of default_column_names()), in C or
/// Fortran order, or of a structured type with fields x, y, z (or xyz, ... of three values), in either byte order;
/// values keep their type. Arrays of more axes in C order, such as organised clouds, are flattened, with a warning. In
/// an archive the positions are the members x, y and z, or else the member xyz, points, position(s), vertices or
/// coordinates, or else the only member that can hold positions. Members with as many rows as the positions become
/// attributes under their names; others are left out with a warning. Throws Error for other files.
std::unique_ptr<Reader> open_npy_points(const std::filesystem::path& path);

}  // namespace pointsweep
