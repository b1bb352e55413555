// SPDX-License-Identifier: MIT
/// All rows of a cloud with values of the input or of the output: what formulas of the whole cloud read.
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

/// Why a stage is not checked, without a full stop.
class NotTold : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// More than VerifyOptions::memory_bytes are needed.
class NeedsMemory : public NotTold {
 public:
  using NotTold::NotTold;
};

/// The source of the values of an attribute.
struct ColumnSource {
  Attribute attribute;
  std::vector<Field> in_input = {};         ///< by component; or
  std::vector<FieldPair> in_output = {};    ///< by component
  std::optional<FieldPair> turned_by = {};  ///< where this is not 0 in the output, it holds the negative
  std::shared_ptr<const std::vector<double>> made_again = {};  ///< or these, by row of the input, then component
};

class CloudRows {
 public:
  /// `axis`: of the sweep in whose order the rows of `out` are; negative: the rows of `out` are in input order.
  /// `has_all`: the output has all rows of the input. Borrows both.
  CloudRows(RowSource& in, RowSource& out, int axis, std::uint64_t memory_bytes, const PhaseProgress& progress,
            bool has_all = true)
      : in_(in), out_(out), axis_(axis), memory_bytes_(memory_bytes), progress_(progress), has_all_(has_all) {}

  std::uint64_t count() const { return in_.count(); }
  std::uint64_t memory_bytes() const { return memory_bytes_; }
  const PhaseProgress& progress() const { return progress_; }
  /// Times that all of the input was read.
  std::uint64_t passes() const { return passes_; }
  RowSource& input() { return in_; }
  /// Returns whether the output has all rows; otherwise no column may be a column of the output.
  bool output_has_all() const { return has_all_; }

  /// Throws NotTold where the output has another order than the input, and values of the columns in the output do not
  /// fit the memory.
  void require(std::span<const ColumnSource> columns) const;
  /// Calls `use` for every row in the order of the input, with the components of the columns one after another. Throws
  /// as require().
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

/// "6.2 GiB" and the like.
std::string bytes_text(std::uint64_t bytes);
/// Throws NeedsMemory unless that much may be used.
void require_memory(std::uint64_t bytes, const CloudRows& rows);

}  // namespace pointsweep
