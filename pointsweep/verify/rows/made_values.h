// SPDX-License-Identifier: MIT
/// The values of an output that a run has made, compared with what their formulas give.
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
