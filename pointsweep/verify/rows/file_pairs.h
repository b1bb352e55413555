// SPDX-License-Identifier: MIT
/// The pairs of fields by which two clouds of several files are compared, and the values that a run has made, as the
/// file of each row stores them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/verify/formulas/estimate.h"
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

/// The values of an output that a run has made, compared with what their formulas give.
class MadeValues {
 public:
  /// Borrows the output.
  explicit MadeValues(const RowSource& out) : files_(out.files()) {}

  bool empty() const { return values_.empty(); }
  std::size_t size() const { return values_.size(); }
  /// Adds a value that is compared with estimate number `estimate` of each point.
  void add(std::size_t estimate, MadeValue value) { values_.emplace_back(estimate, std::move(value)); }
  /// Removes the values whose estimate e has told[e] == false.
  void keep(const std::vector<bool>& told);
  /// Returns how many of the values of a point its estimates leave open.
  std::uint64_t open_values(const formulas::Estimate* estimates) const;

  /// Returns a sentence about the first value in which a point differs from row `place` of the output, whose record is
  /// `record`. `row`: row of the input; `result`: the values in the types of the run.
  std::optional<std::string> difference_at(std::uint64_t place, std::uint64_t row, const std::byte* result,
                                           const formulas::Estimate* estimates, const std::byte* record);

 private:
  using NumberedValue = std::pair<std::size_t, MadeValue>;  ///< number of the estimate, and the value
  std::span<const NumberedValue> in_file_of(std::uint64_t place);

  std::span<const FileOfRows> files_;
  std::vector<NumberedValue> values_;
  std::optional<std::size_t> file_;     ///< file to which `in_file_` belongs
  std::vector<NumberedValue> in_file_;  ///< the values as that file stores them
};

}  // namespace pointsweep
