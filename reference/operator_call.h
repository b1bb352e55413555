// SPDX-License-Identifier: MIT
/// applyOperator of the paper's Figures 12 and 14: hands points to an operator's formula, and its results to the
/// points.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/points/degenerate_rows.h"
#include "pointsweep/row_error.h"
#include "reference/fields.h"

namespace pointsweep::reference {

/// Applies an operator of the engine. Operators take batches in columns, so the points that an operator may process at
/// one moment are gathered into batches, a few points at a time.
class OperatorCall {
 public:
  /// `between`: called after every few points.
  OperatorCall(const Stage& stage, std::function<void()> between) : stage_(stage), between_(std::move(between)) {}

  /// A point enters the operator's buffer.
  void copy_fields(StreamPoint& point) const;
  void apply(std::span<StreamPoint* const> points);
  const DegenerateRows& degenerate() const { return degenerate_; }
  /// Returns the error of the lowest row so far that the operator refuses.
  const FirstRowError& refused() const { return refused_; }

 private:
  /// Positions, rows and values of some points, in columns.
  struct Gathered {
    std::vector<double> x, y, z;
    std::vector<std::uint64_t> row;
    std::vector<std::vector<std::byte>> values;

    void start(std::size_t attributes);
    void add(Vec3 position, const StreamPoint& point);
    void add_values(StreamPoint& point, const std::vector<Field>& fields);
  };
  void gather(std::span<StreamPoint* const> points);
  void lay_out_slots();
  void apply_gathered(std::span<StreamPoint* const> points);

  const Stage& stage_;
  std::function<void()> between_;
  Gathered own_, near_;
  std::vector<std::uint32_t> begin_, refs_;
  std::vector<const std::byte*> pointers_;  ///< of the slots' columns
  std::vector<PointColumns> slots_;
  DegenerateRows degenerate_;
  FirstRowError refused_;
};

}  // namespace pointsweep::reference
