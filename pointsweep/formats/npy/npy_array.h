// SPDX-License-Identifier: MIT
/// NumPy arrays of neighbours and distances: read as rows of values, written from one field (format version 1.0).
#pragma once

#include <filesystem>
#include <memory>

#include "pointsweep/formats/records/record_writer.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// A little-endian, C-ordered array of one or two dimensions (format versions 1 to 3). Its schema has one field for
/// each column: neighbor_0, ... for integers, distance_0, ... for floating numbers. Throws Error for anything else.
std::unique_ptr<Reader> open_npy(const std::filesystem::path& path);

/// The schema of the plan has one plain field; the array has shape (n, count), or (n,) if the count is 1 and the
/// attribute in OutputPlan::made is not a list, in C order and little-endian. numpy.load(path, mmap_mode="r") opens one
/// of any size.
class NpyWriter final : public RecordWriter {
 public:
  explicit NpyWriter(const OutputPlan& plan);
};

}  // namespace pointsweep
