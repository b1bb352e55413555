// SPDX-License-Identifier: MIT
/// The interface every local operator implements (paper Definition 4.1; Figure 11 seen from the operator's side).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/operators/reduction.h"
#include "pointsweep/points/attribute.h"
#include "pointsweep/points/neighborhoods.h"
#include "pointsweep/points/option_value.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Which rows are left for all later stages and for the output. Their neighbours are found among these alone.
enum class Selects : std::uint8_t {
  nothing,         ///< all rows stay
  by_value,        ///< those for which the operator makes selection_attribute() not 0; nonfinite points are asked too
  first_of_equal,  ///< of points with equal coordinates the first row; points without a finite place are never equal
};

/// What an operator looks at and what it makes. From this alone the engine derives how long points are buffered before
/// it (paper Section 5.2): nothing in `reads_neighbors` makes it a through-buffer, anything else a pre-buffer.
struct Contract {
  std::vector<Attribute> reads;            ///< of the point itself, in addition to its position
  std::vector<Attribute> reads_neighbors;  ///< of the points in N_i, in addition to their positions
  std::vector<Attribute> makes;
  bool alone = false;  ///< never looks at a neighbour, not even at its position: need not wait for those that moved
  Selects selects = Selects::nothing;  ///< if not nothing, it is alone and makes selection_attribute() and nothing else
  std::vector<std::shared_ptr<const Reduction>> values = {};  ///< of the whole cloud, given by with_values()
};

/// What a selecting operator makes. Never written.
inline Attribute selection_attribute() {
  return {"row is kept", Type::u8, Kind::scalar, {"row is kept"}, "1", "0: the row is left out", std::byte{1}};
}

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

  /// The operators, in order, that this one is short for; apply() is called of them only. Empty: it stands for itself.
  virtual std::vector<std::shared_ptr<const Operator>> parts() const { return {}; }
  /// The same operator for a cloud with the fields of `input`, after stages that make `made`, where its contract
  /// depends on these. Null: it does not. Throws UsageError.
  virtual std::shared_ptr<const Operator> bound(const Schema& input, std::span<const Attribute> made) const {
    (void)input, (void)made;
    return nullptr;
  }
  /// The same operator that knows the values of the whole cloud, by number in contract().values. Called before apply()
  /// if there are any.
  virtual std::shared_ptr<const Operator> with_values(std::span<const std::vector<double>> values) const {
    (void)values;
    return nullptr;
  }

  /// All that tells objects of this class apart. Name and options are part of what a run is: --resume refuses a run
  /// with other options, and outputs say them. Those of its declaration if it was made from one.
  Options declared_options() const { return declared_ ? *declared_ : own_options(); }
  /// The first call counts: that of a maker that knows better, or that of make_stage().
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
