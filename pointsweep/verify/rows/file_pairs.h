// SPDX-License-Identifier: MIT
/// The pairs of fields by which two clouds of several files are compared.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/verify/rows/field_pair.h"
#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// Returns the number of the file that has row `row`.
std::size_t file_of_row(std::span<const FileOfRows> files, std::uint64_t row);

/// The pairs of fields for each row, as the file of the row stores the values (FieldPair::in_files). Only the pairs of
/// one file of each cloud are kept, so ascending rows are fastest.
class FilePairs {
 public:
  /// Borrows the sources. If they have equally many files, file i of the output is taken to hold rows of file i of the
  /// input. `in_any_order`: true if rows of the output may be in any file.
  FilePairs(const RowSource& in, const RowSource& out, bool in_any_order, std::vector<FieldPair> pairs);

  const std::vector<FieldPair>& all() const { return pairs_; }
  std::span<const FieldPair> of_input(std::uint64_t row) { return of(in_, row); }
  std::span<const FieldPair> of_output(std::uint64_t row) { return of(out_, row); }

 private:
  struct Side {
    std::span<const FileOfRows> files;
    std::uint64_t count;               ///< number of rows
    std::uint64_t first = 0, end = 0;  ///< rows of the file to which `pairs` belong
    std::vector<FieldPair> pairs = {};
  };
  std::span<const FieldPair> of(Side& side, std::uint64_t row);

  std::vector<FieldPair> pairs_;
  Side in_, out_;
  bool by_file_;
};

}  // namespace pointsweep
