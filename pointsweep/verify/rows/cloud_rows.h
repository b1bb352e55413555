// SPDX-License-Identifier: MIT
/// All rows of a cloud with values of the input, of the output, or computed again, for formulas that read the whole
/// cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/geometry.h"
#include "pointsweep/verify/rows/field_pair.h"
#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// An exception that tells why a stage is not checked. Its text has no full stop.
class NotTold : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Thrown if a check needs more memory than VerifyOptions::memory_bytes.
class NeedsMemory : public NotTold {
 public:
  using NotTold::NotTold;
};

/// The source of the values of an attribute: exactly one of `in_input`, `in_output` and `made_again` is set.
struct ColumnSource {
  Attribute attribute;
  std::vector<Field> in_input = {};         ///< field of the input for each component
  std::vector<FieldPair> in_output = {};    ///< field of the output for each component
  std::optional<FieldPair> turned_by = {};  ///< field of the output that is not 0 where orient() has negated the value
  /// Values that were computed again: for each row of the input, one value for each component.
  std::shared_ptr<const std::vector<double>> made_again = {};
};

class CloudRows {
 public:
  /// `axis`: axis along which the rows of `out` are ordered; negative if they are in the order of the input. `has_all`:
  /// true if the output has all rows of the input. Borrows both sources.
  CloudRows(RowSource& in, RowSource& out, int axis, std::uint64_t memory_bytes, const PhaseProgress& progress,
            bool has_all = true)
      : in_(in), out_(out), axis_(axis), memory_bytes_(memory_bytes), progress_(progress), has_all_(has_all) {}

  std::uint64_t count() const { return in_.count(); }
  std::uint64_t memory_bytes() const { return memory_bytes_; }
  const PhaseProgress& progress() const { return progress_; }
  /// Returns how many times the whole input was read.
  std::uint64_t passes() const { return passes_; }
  RowSource& input() { return in_; }
  /// Returns whether the output has all rows of the input. If it has not, no column may come from the output.
  bool output_has_all() const { return has_all_; }

  /// Throws NotTold if columns are in the output, the output has another order than the input, and the values do not
  /// fit in memory.
  void require(std::span<const ColumnSource> columns) const;
  /// Calls `use` for every row in the order of the input, with the components of the columns one after another. Throws
  /// NotTold like require().
  void for_each(std::span<const ColumnSource> columns,
                const std::function<void(std::uint64_t row, Vec3 position, std::span<const double> values)>& use);

 private:
  std::vector<double> values_in_order_of_input(std::span<const ColumnSource> columns, std::size_t components);

  RowSource &in_, &out_;
  int axis_;
  std::uint64_t memory_bytes_, passes_ = 0;
  const PhaseProgress& progress_;
  bool has_all_;
};

/// Returns a number of bytes in binary units, in the form of --memory: "512M" or "6.2G", rounded up.
std::string bytes_text(std::uint64_t bytes);
/// Throws NeedsMemory if `bytes` exceed the allowed memory.
void require_memory(std::uint64_t bytes, const CloudRows& rows);

}  // namespace pointsweep
