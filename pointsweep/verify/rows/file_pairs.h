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

/// The pairs for a row, in the ways in which its files store the values (FieldPair::in_files). Rows are best asked for
/// in ascending order, since the pairs of one file of each cloud are kept.
class FilePairs {
 public:
  /// Borrows the sources. If they have equally many files, each file of the output has rows of one file of the input,
  /// in the same order; `in_any_order`: rows of the output may be anywhere.
  FilePairs(const RowSource& in, const RowSource& out, bool in_any_order, std::vector<FieldPair> pairs);

  const std::vector<FieldPair>& all() const { return pairs_; }
  std::span<const FieldPair> of_input(std::uint64_t row) { return of(in_, row); }
  std::span<const FieldPair> of_output(std::uint64_t row) { return of(out_, row); }

 private:
  struct Side {
    std::span<const FileOfRows> files;
    std::uint64_t count;               ///< number of rows
    std::uint64_t first = 0, end = 0;  ///< rows of the file of `pairs`
    std::vector<FieldPair> pairs = {};
  };
  std::span<const FieldPair> of(Side& side, std::uint64_t row);

  std::vector<FieldPair> pairs_;
  Side in_, out_;
  bool by_file_;
};

}  // namespace pointsweep
