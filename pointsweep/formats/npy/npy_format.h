// SPDX-License-Identifier: MIT
/// Readers of NumPy arrays of neighbours and distances as rows, and of points in .npy files and .npz archives; a writer
/// of arrays.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "pointsweep/formats/records/record_writer.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// Opens a little-endian, C-ordered array of one or two dimensions (format versions 1 to 3). The schema has one field
/// for each column: neighbor_0, ... for uint32 and uint64, distance_0, ... for float64. Throws Error for other arrays.
std::unique_ptr<Reader> open_npy(const std::filesystem::path& path);

/// Writes an array. The schema of the plan must have one plain field. The array has shape (n, count), or (n,) if the
/// count is 1 and the attribute in OutputPlan::made is not a list, in C order and little-endian. numpy.load(path,
/// mmap_mode="r") opens an array of any size.
class NpyWriter final : public RecordWriter {
 public:
  explicit NpyWriter(const OutputPlan& plan);
};

/// Returns whether a file that begins with `head` is a NumPy array or an archive of NumPy arrays.
bool starts_as_npy_points(std::string_view head);

/// Opens an array of n rows and three columns or more (x, y, z, then the names of default_column_names()), in C or
/// Fortran order, or of a structured type with fields x, y, z (or xyz, ... of three values), in either byte order;
/// values keep their type. Arrays with more axes, such as organised clouds, are flattened, with a warning. In an
/// archive the positions are the member xyz, points, position(s), vertices or coordinates, or members x, y and z, or
/// the only member that can hold positions. Members with as many rows as the positions become attributes under their
/// names; others are left out with a warning. Throws Error for other files.
std::unique_ptr<Reader> open_npy_points(const std::filesystem::path& path);

}  // namespace pointsweep
