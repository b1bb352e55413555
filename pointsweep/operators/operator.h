// SPDX-License-Identifier: MIT
/// The interface every local operator implements (paper Definition 4.1; Figure 11 seen from the operator's side).
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/points/attribute.h"
#include "pointsweep/points/neighborhoods.h"
#include "pointsweep/points/option_value.h"

namespace pointsweep {

/// What an operator looks at and what it makes. From this alone the engine derives how long points are buffered before
/// it (paper Section 5.2): nothing in `reads_neighbors` makes it a through-buffer, anything else a pre-buffer.
struct Contract {
  std::vector<Attribute> reads;            ///< of the point itself, besides its position
  std::vector<Attribute> reads_neighbors;  ///< of the points in N_i, besides their positions
  std::vector<Attribute> makes;
  bool alone = false;  ///< never looks at a neighbour, not even at its position: need not wait for those that moved
};

/// A pure function of a point and its neighbourhood: the same input gives the same bytes, on any thread, at any time,
/// in any batch. It never queues, waits, counts references or keeps state between calls.
class Operator {
 public:
  virtual ~Operator() = default;
  virtual std::string name() const = 0;
  virtual Contract contract() const = 0;
  /// Fills out.column(m)[i] for every point i of the batch and every made attribute m; all are 0 before. Called from
  /// many threads at once. Neighbours come nearest first only if in.sorted_by_distance(): see Neighborhoods.
  virtual void apply(const Neighborhoods& in, Columns& out) const = 0;

  /// All that tells objects of this class apart. Name and options are part of what a run is: --resume refuses a run
  /// with other options, and outputs say them. Those of its declaration if it was made from one.
  Options declared_options() const { return declared_ ? *declared_ : own_options(); }
  /// The first call counts: that of a maker that knows better, or that of make_operator().
  void declare_options(Options options) {
    if (!declared_) declared_ = std::move(options);
  }

 protected:
  /// To be overridden by a class whose objects can differ, e.g. {{"width", width_}}.
  virtual Options own_options() const { return {}; }

 private:
  std::optional<Options> declared_;
};

/// What an operator says of itself (declaration.h). Declared here so that its header can name the function that gives
/// it.
struct OperatorDeclaration;

}  // namespace pointsweep
