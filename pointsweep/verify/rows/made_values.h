// SPDX-License-Identifier: MIT
/// The values that a run has made: their names in the output, and their comparison with the estimates of formulas.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/verify/formulas/estimate.h"
#include "pointsweep/verify/rows/field_pair.h"

namespace pointsweep {

/// Returns the schema of records of the values of `made`, in this order, with `prefix` before all names but x, y and z.
Schema schema_of_made(const std::vector<Attribute>& made, const std::string& prefix);

/// Returns whether `name`, a field of an output, is a name under which a writer stores a field of `schema`.
bool is_field_of(const Schema& schema, const std::string& name);

/// The function Format::own_field of a format; null for a format that adds no fields.
using OwnField = std::optional<double> (*)(std::string_view name);

/// Returns the fields among `names` that belong to the format of `out` and hold their default values in all rows, apart
/// from the values that a writer derives: the overlap flag of class 12, and the state of a point that is not finite.
std::vector<std::string> unfilled_fields(RowSource& out, const std::vector<std::string>& names, OwnField own_field);

/// The one to three components of an attribute that share one estimate, and their fields in the output.
class MadeValue {
 public:
  /// `pairs`: for each component, the pair of a field of result records and a field of the output; absent for a
  /// component that was not written.
  explicit MadeValue(std::vector<std::optional<FieldPair>> pairs) : pairs_(std::move(pairs)) {}
  /// Returns this value, to be compared as a file with the schema `to` stores it (FieldPair::in_files).
  MadeValue in_file(const Schema& to) const;

  /// Returns a wrong component; nothing if the value is right or its estimate is open. Estimates without error are
  /// compared by FieldPair, bit for bit if the types are equal, and the first wrong component is returned. Other values
  /// may differ by their error and one rounding to the type of the output; the component that differs most is returned.
  std::optional<std::size_t> wrong_component(const formulas::Estimate& estimate, const std::byte* result,
                                             const std::byte* record) const;
  /// Returns "nx is 0.3, but 0.2 by brute force, give or take 1e-07".
  std::string difference(std::size_t component, const formulas::Estimate& estimate, const std::byte* result,
                         const std::byte* record) const;

  /// Returns the distance of the output's value from the nearest right value, beyond the rounding of its type; 0 if
  /// rounding explains the difference.
  formulas::Real distance(const formulas::Estimate& estimate, const std::byte* record) const;

 private:
  formulas::Real distance_to(formulas::Vector expected, const std::byte* record) const;

  std::vector<std::optional<FieldPair>> pairs_;
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
  /// Keeps only the values with told[e] true, where e is the number of the estimate.
  void keep(const std::vector<bool>& told);
  /// Returns the number of values of a point whose estimates are open (formulas::Estimate).
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
  std::vector<NumberedValue> in_file_;  ///< the values, to be compared as that file stores them
};

}  // namespace pointsweep
