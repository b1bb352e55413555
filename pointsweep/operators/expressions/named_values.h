// SPDX-License-Identifier: MIT
/// The attributes that the names of an expression mean, and their values for a batch of points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators/expressions/expression.h"

namespace pointsweep {

/// The meanings of the names of an expression. A name means, in this order: a component of an attribute that was made
/// before ("nz", "outlier"); x, y or z, the current position; a field of the input, in any spelling that files use
/// (meant_value.h), but no array; `row`, the number of the row in the inputs.
class NamedValues {
 public:
  NamedValues() = default;
  /// Messages begin with `place`. Throws UsageError for an unknown name, with the known names.
  NamedValues(const Expression& expression, const std::string& place, const Schema& input,
              std::span<const Attribute> made);

  /// Returns the attributes that must be read, each once.
  const std::vector<Attribute>& reads() const { return reads_; }

  /// The values of one batch, in the order of the names.
  class Batch {
   public:
    /// Reads the values of the points of the batch. `first`: index of the first attribute of reads() in the
    /// contract().reads of the operator.
    Batch(const NamedValues& names, const Neighborhoods& in, std::size_t first = 0);
    /// Reads the values of some neighbours of the batch. `first`: index of the first attribute of reads() in the
    /// contract().reads_neighbors of the operator.
    Batch(const NamedValues& names, const Neighborhoods& in, std::size_t first, std::span<const NeighborRef> neighbors);
    std::span<const ExpressionValues> values() const { return values_; }

   private:
    /// Reads the values of `count` points. `position(i)` returns the position of point i, `record(a, i, bytes)` the
    /// address of its value of reads()[a], which has `bytes` bytes.
    template <class Position, class Record>
    void take(const NamedValues& names, std::size_t count, Position position, Record record);

    /// The memory of the values of one name, to which the pointers in values_ point.
    struct Memory {
      std::vector<double> real;
      std::vector<std::uint64_t> whole;
    };
    std::vector<Memory> memory_;
    std::vector<ExpressionValues> values_;
  };

  /// The source of the values of a name: component `component` of reads()[attribute], or of the position of the point
  /// if `attribute` is negative.
  struct Source {
    int attribute = -1;
    std::size_t component = 0;
  };
  const std::vector<Source>& sources() const { return sources_; }

 private:
  Source read(Attribute attribute, std::size_t component);

  std::vector<Attribute> reads_;
  std::vector<Source> sources_;  ///< in the order of Expression::names()
};

}  // namespace pointsweep
