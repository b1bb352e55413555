// SPDX-License-Identifier: MIT
/// Values of the whole cloud, which operators need before their first point: a mean, a deviation, a diagonal.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/points/attribute.h"

namespace pointsweep {

/// Takes the points of a part of the cloud. Its result depends only on the set of points that it and those merged into
/// it took, not on their order or division: sums are exact (math/exact_sum.h).
class Accumulator {
 public:
  virtual ~Accumulator() = default;
  /// Takes `points` points; `values` holds the components of Reduction::reads() of one point after another, as float64.
  virtual void add(const double* values, std::size_t points) = 0;
  /// Takes what `other`, of the same reduction, took.
  virtual void merge(const Accumulator& other) = 0;
  virtual std::vector<double> finish() const = 0;
};

/// Of the points that are left when the pass ends that makes what it reads: all of them, or those that a select keeps.
class Reduction {
 public:
  virtual ~Reduction() = default;
  /// What it is, with its options. Reductions of one text over the same attributes are done once.
  virtual std::string text() const = 0;
  virtual std::vector<Attribute> reads() const = 0;
  /// Whether it reads the values that the input has, whatever earlier stages have made; it costs no sweep then.
  virtual bool of_input() const { return false; }
  virtual std::unique_ptr<Accumulator> start() const = 0;
};

}  // namespace pointsweep
