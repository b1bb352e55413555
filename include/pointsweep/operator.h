// SPDX-License-Identifier: MIT
/// Base classes for operators of your own:
///   LocalOperator      makes attributes from a point and its neighbours (paper Definition 4.1; Figure 11)
///   PointOperator      a LocalOperator that takes a point at a time
///   SelectOperator     drops rows by a condition on the point
///   InOrderOperator    takes all points in order, and drops rows or makes attributes (in_order_operator.h)
///   CompositeOperator  stands for a sequence of other stages (chain.h)
///
///   class Roughness final : public PointOperator {
///     std::string name() const override { return "roughness"; }
///     Contract contract() const override {
///       return {.reads = {normal_attribute()},
///               .makes = {scalar("roughness", Type::f32, "length", "distance to the plane of the neighbours")}};
///     }
///     void apply_to(std::size_t i, const Neighborhoods& in, Columns& out) const override { ... }
///   };
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/error.h"
#include "pointsweep/export.h"
#include "pointsweep/geometry.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/option.h"

namespace pointsweep {

class DegeneratePoints;

/// The state of a reduction over a part of the cloud. The result of finish() depends only on the set of points that
/// this and all merged accumulators have taken, not on the order or division of the points. So results do not depend on
/// threads; sums must be exact.
class POINTSWEEP_EXPORT Accumulator {
 public:
  virtual ~Accumulator() = default;
  /// Takes `points` points. `values` holds the components of Reduction::reads() as float64, point after point.
  virtual void add(const double* values, std::size_t points) = 0;
  /// Adds all points that `other`, an accumulator of the same reduction, has taken.
  virtual void merge(const Accumulator& other) = 0;
  /// Returns the state as bytes for load() in another process. Only runs of several processes call save() and load(),
  /// which throw Error unless they are overridden.
  virtual std::vector<std::byte> save() const {
    throw Error("An accumulator is to be saved that does not override save().");
  }
  /// Restores the state from `bytes`, saved by an accumulator of the same reduction. Throws Error for bytes of another
  /// kind or length.
  virtual void load(std::span<const std::byte>) {
    throw Error("An accumulator is to be loaded that does not override load().");
  }
  virtual std::vector<double> finish() const = 0;
};

/// A value of the whole cloud that operators need before their first point: a mean, a deviation, a diagonal. It covers
/// the points that are left at the end of the pass that makes the attributes it reads: all points, or the points that a
/// select keeps.
class POINTSWEEP_EXPORT Reduction {
 public:
  virtual ~Reduction() = default;
  /// Returns a description of the value, with its options. Reductions with equal texts over equal attributes are
  /// computed once.
  virtual std::string text() const = 0;
  virtual std::vector<Attribute> reads() const = 0;
  /// Returns whether the reduction reads the values of the input even if earlier stages have changed them, so that it
  /// needs no sweep.
  virtual bool of_input() const { return false; }
  virtual std::unique_ptr<Accumulator> start() const = 0;
};

/// The attributes that an operator reads and makes. From these alone the engine derives how long points wait in a
/// buffer before the operator gets them (paper Section 5.2): with an empty `reads_neighbors` the operator has a
/// through-buffer, else a pre-buffer. If neither the input nor an earlier stage has an attribute, the run throws
/// UsageError before it reads a point. To move points, make position_attribute().
struct Contract {
  std::vector<Attribute> reads = {};            ///< attributes of the point itself, in addition to its position
  std::vector<Attribute> reads_neighbors = {};  ///< attributes of the points in N_i, in addition to their positions
  std::vector<Attribute> makes = {};
  std::vector<std::shared_ptr<const Reduction>> values = {};  ///< values of the whole cloud, passed to with_values()
  /// The default number of neighbours, for chains that state none (Neighborhood::kOfOperators). 0 if the operator reads
  /// no neighbours, not even their positions: the operator then does not wait for neighbours that move, and also gets
  /// points with non-finite coordinates. Other operators do not get points with non-finite coordinates. The position of
  /// such a point, and attributes that the operator both reads and makes, stay unchanged; other made attributes are
  /// Attribute::fill.
  std::size_t default_k = 8;
  /// The radius within which the operator reads all neighbours, in units of the coordinates, 0 or more; absent if it
  /// has no such radius. A chain that states no neighbourhood, and whose operators that read neighbours all have such a
  /// radius, uses the largest of them.
  std::optional<double> all_within = {};
};

/// The attribute that a stage makes to drop rows: 1 keeps the row, 0 drops it. It is never written.
inline Attribute selection_attribute() {
  return {"row is kept", Type::u8, Kind::scalar, {"row is kept"}, "1", "0: the row is left out", std::byte{1}};
}

/// The columns that an operator fills for a batch, in the order of its contract().makes. The engine makes the columns.
class POINTSWEEP_EXPORT Columns {
 public:
  /// `degenerate` receives the marked points. `unwanted`: for each column, true if it is neither read nor written to an
  /// output; missing entries are false. `bytes`: for each column, bytes of a value; empty if types are not checked.
  Columns(std::span<std::byte* const> made, std::size_t size, DegeneratePoints& degenerate,
          std::vector<bool> unwanted = {}, std::vector<std::size_t> bytes = {})
      : made_(made), size_(size), degenerate_(&degenerate), unwanted_(std::move(unwanted)), bytes_(std::move(bytes)) {}

  /// Returns the number of points in the batch.
  std::size_t size() const { return size_; }
  /// Returns column `m` of contract().makes, all 0 before the operator runs. T is the type of a whole value of
  /// Attribute::bytes() bytes, e.g. std::array<float, 3> or float. If the engine made the columns, a type of another
  /// size throws UsageError, except std::byte.
  template <class T>
  std::span<T> column(std::size_t m) {
    assert(m < made_.size());
    if constexpr (!std::is_same_v<T, std::byte>)
      if (!bytes_.empty() && bytes_[m] != sizeof(T)) [[unlikely]]
        refuse_value_size(bytes_[m], sizeof(T));
    return {reinterpret_cast<T*>(made_[m]), size_};
  }
  /// Returns false if column `m` is neither read nor written to an output. An operator may then skip the work and leave
  /// the column unchanged.
  bool wanted(std::size_t m) const { return m >= unwanted_.size() || !unwanted_[m]; }
  /// Marks point i as degenerate: its data define no result, and it gets the documented value. Statistics counts marked
  /// points.
  void mark_degenerate(std::size_t i);
  /// Returns the marked points, for the engine.
  DegeneratePoints& degenerate() { return *degenerate_; }

 private:
  std::span<std::byte* const> made_;
  std::size_t size_;
  DegeneratePoints* degenerate_;
  std::vector<bool> unwanted_;
  std::vector<std::size_t> bytes_;
};

/// The base of operators of all kinds. An operator that you write derives from one of the kinds below.
class POINTSWEEP_EXPORT Operator {
 public:
  virtual ~Operator() = default;
  /// Returns the name of the operator in plans, statistics and the records in outputs.
  virtual std::string name() const = 0;
  virtual Contract contract() const = 0;

  /// Returns the options that distinguish objects of this class: the declared options, else own_options(). Name and
  /// options are part of a run: `resume_folder` refuses a run with other options, and outputs record them.
  Options declared_options() const { return declared_ ? *declared_ : own_options(); }
  /// Sets the declared options. Calls after the first are no-ops: the constructor of a base class, which runs first,
  /// decides.
  void declare_options(Options options) {
    if (!declared_) declared_ = std::move(options);
  }

 protected:
  /// Returns the options of the object. Must be overridden in a class whose objects can differ, e.g. to return
  /// {{"width", width_}}.
  virtual Options own_options() const { return {}; }

 private:
  std::optional<Options> declared_;
};

/// A pure function of a point and its neighbourhood: the same input gives the same bytes, on any thread, at any time,
/// in any batch. It keeps no state between calls.
class POINTSWEEP_EXPORT LocalOperator : public Operator {
 public:
  /// Fills out.column(m)[i] for every point i of the batch and every made attribute m; all values are 0 before the
  /// call. Called from many threads at once. Neighbours come nearest first only if in.sorted_by_distance(): see
  /// Neighborhoods.
  virtual void apply(const Neighborhoods& in, Columns& out) const = 0;

  /// Returns the operator for a cloud with the fields of `input`, after stages that make `made`; null if its contract
  /// does not depend on either. Throws UsageError for a cloud that does not fit.
  virtual std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const {
    (void)input, (void)made;
    return nullptr;
  }
  /// Returns the operator with the values of the whole cloud, in the order of contract().values. Called before apply()
  /// if contract().values is not empty; must then be overridden.
  virtual std::shared_ptr<const LocalOperator> with_values(std::span<const std::vector<double>> values) const {
    (void)values;
    return nullptr;
  }
  /// Returns for each of x, y and z whether the operator may turn it into a coordinate of another reference system.
  /// The library calls this function only for operators that make position_attribute().
  virtual std::array<bool, 3> changes_system() const { return {true, true, true}; }
};

/// An operator that takes the points of a batch one at a time. The overhead is a virtual call per point, about 2 ns.
class POINTSWEEP_EXPORT PointOperator : public LocalOperator {
 public:
  void apply(const Neighborhoods& in, Columns& out) const final {
    for (std::size_t i = 0; i < in.size(); ++i) apply_to(i, in, out);
  }

 protected:
  /// Fills out.column(m)[i] for every made attribute m. Called from many threads at once.
  virtual void apply_to(std::size_t i, const Neighborhoods& in, Columns& out) const = 0;
};

/// A condition on a point. Rows that it does not keep are dropped: later stages, the output and neighbourhoods do not
/// contain them. Points with non-finite coordinates are tested, too.
class POINTSWEEP_EXPORT SelectOperator : public Operator {
 public:
  /// Returns the attributes of the point that the condition reads, in addition to its position.
  virtual std::vector<Attribute> reads() const { return {}; }
  /// Sets kept[i] to 1 for every point i of the batch whose row is kept; all values are 0 before the call. `points`
  /// have no neighbours. Called from many threads at once.
  virtual void keep(const Neighborhoods& points, std::span<std::uint8_t> kept) const = 0;
  /// Returns the operator for a cloud with the fields of `input`, after stages that make `made`; null if its contract
  /// does not depend on either.
  virtual std::shared_ptr<const SelectOperator> bound(const Schema& input, std::span<const Attribute> made) const {
    (void)input, (void)made;
    return nullptr;
  }
  /// Returns a box in x and y, with z = 0, that contains all kept points; nothing if such a box is unknown.
  virtual std::optional<Box> extent() const { return std::nullopt; }

  Contract contract() const final { return {.reads = reads(), .makes = {selection_attribute()}, .default_k = 0}; }
};

}  // namespace pointsweep
