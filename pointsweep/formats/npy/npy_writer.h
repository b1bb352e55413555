// SPDX-License-Identifier: MIT
/// Writing one field as an array for NumPy (format version 1.0).
#pragma once

#include "pointsweep/formats/records/record_writer.h"

namespace pointsweep {

/// The schema of the plan has one plain field; the array has shape (n, count), or (n,) if the count is 1 and the
/// attribute in OutputPlan::made is not a list, in C order and little-endian. numpy.load(path, mmap_mode="r") opens one
/// of any size.
class NpyWriter final : public RecordWriter {
 public:
  explicit NpyWriter(const OutputPlan& plan);
};

}  // namespace pointsweep
