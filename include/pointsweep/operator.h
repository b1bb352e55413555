// SPDX-License-Identifier: MIT
/// The interface every local operator implements (paper Definition 4.1; Figure 11 seen from the operator's side).
///
/// An operator of your own derives from Operator, or from PointOperator where a point at a time is convenient:
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
#include "pointsweep/export.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/option.h"

namespace pointsweep {

class DegeneratePoints;

/// Takes the points of a part of the cloud. Its result depends only on the set of points that it and those merged into
/// it took, not on their order or division, so that results do not depend on threads: sums must be exact.
class POINTSWEEP_EXPORT Accumulator {
 public:
  virtual ~Accumulator() = default;
  /// Takes `points` points; `values` holds the components of Reduction::reads() of one point after another, as float64.
  virtual void add(const double* values, std::size_t points) = 0;
  /// Takes what `other`, of the same reduction, took.
  virtual void merge(const Accumulator& other) = 0;
  virtual std::vector<double> finish() const = 0;
};

/// Values of the whole cloud that operators need before their first point: a mean, a deviation, a diagonal. Of the
/// points that are left when the pass ends that makes what it reads: all of them, or those that a select keeps.
class POINTSWEEP_EXPORT Reduction {
 public:
  virtual ~Reduction() = default;
  /// What it is, with its options. Reductions of one text over the same attributes are done once.
  virtual std::string text() const = 0;
  virtual std::vector<Attribute> reads() const = 0;
  /// Whether it reads the values that the input has, whatever earlier stages have made; it costs no sweep then.
  virtual bool of_input() const { return false; }
  virtual std::unique_ptr<Accumulator> start() const = 0;
};

/// Which rows are left for all later stages and for the output. Their neighbours are found among these alone.
enum class Selects : std::uint8_t {
  nothing,   ///< all rows stay
  by_value,  ///< those for which the operator makes selection_attribute() not 0; nonfinite points are asked too
  in_order,  ///< as Operator::thinning() decides, which takes the points in order; nonfinite points all stay
};

/// Points on their way into a Thinning. They ascend by place along one axis, then by x, y and z of the place, then by
/// row: points of one place follow one another.
struct OrderedPoints {
  std::span<const Vec3> places;         ///< Operator::place_of() their positions
  std::span<const Vec3> positions;      ///< finite
  std::span<const std::uint64_t> rows;  ///< of those that earlier selects have left
  std::span<const double> values;       ///< the components of contract().reads, of one point after another
};

/// What a Thinning has decided. A row that is never named stays.
struct Decided {
  std::vector<std::uint64_t> left_out;
};

/// Decides which points stay while all points of the cloud come in order. Which these are depends only on the set of
/// points, not on how they are divided into calls.
class POINTSWEEP_EXPORT Thinning {
 public:
  virtual ~Thinning() = default;
  /// Takes the next points; appends rows that it is sure of to `decided`, also of points that came before.
  virtual void add(const OrderedPoints& points, Decided& decided) = 0;
  /// After the last point.
  virtual void finish(Decided& decided) = 0;
};

/// What a Thinning may have to know before the first point.
struct ThinningSetup {
  int axis = 0;                    ///< along which points ascend
  std::uint64_t memory_bytes = 0;  ///< that it may hold
};

/// What an operator looks at and what it makes. From this alone the engine derives how long points are buffered before
/// it (paper Section 5.2): nothing in `reads_neighbors` makes it a through-buffer, anything else a pre-buffer. An
/// attribute that neither the input nor an earlier stage has is refused before the first point is read. To move points,
/// make position_attribute().
struct Contract {
  std::vector<Attribute> reads = {};            ///< of the point itself, in addition to its position
  std::vector<Attribute> reads_neighbors = {};  ///< of the points in N_i, in addition to their positions
  std::vector<Attribute> makes = {};
  /// Never looks at a neighbour, not even at its position: need not wait for those that moved, and gets the points
  /// without a finite place, too. Other operators do not get these: such a point keeps its position and what the
  /// operator reads of it and makes again, and has Attribute::fill of all else.
  bool alone = false;
  Selects selects = Selects::nothing;  ///< if not nothing, it is alone and makes selection_attribute() and nothing else
  std::vector<std::shared_ptr<const Reduction>> values = {};  ///< of the whole cloud, given by with_values()
  bool has_places = false;  ///< of an operator that takes points in order: by place_of() their positions
  std::string arrival = {};  ///< of an operator that takes points in order: how they come, "equal ones together"
  double reach = 0;          ///< of a select in order: it may hold points so far behind the newest, and as far again
  std::uint64_t held_bytes = 0;         ///< of memory for each point it holds
  std::vector<std::string> drops = {};  ///< attributes that later stages do not see and that are not written
  /// Number of neighbours that the operator wants where the chain names none (Neighborhood::kOfOperators), unless it is
  /// alone.
  std::size_t default_k = 8;
};

/// What a selecting operator makes. Never written.
inline Attribute selection_attribute() {
  return {"row is kept", Type::u8, Kind::scalar, {"row is kept"}, "1", "0: the row is left out", std::byte{1}};
}

/// The columns an operator fills for a batch, in the order of its contract().makes. The engine makes them.
class POINTSWEEP_EXPORT Columns {
 public:
  /// `degenerate` gets the points that are marked. `unwanted`: by number, the columns that are never read; may be
  /// shorter. `bytes`: of a value, by number; empty: types are not checked.
  Columns(std::span<std::byte* const> made, std::size_t size, DegeneratePoints& degenerate,
          std::vector<bool> unwanted = {}, std::vector<std::size_t> bytes = {})
      : made_(made),
        size_(size),
        degenerate_(&degenerate),
        unwanted_(std::move(unwanted)),
        bytes_(std::move(bytes)) {}

  /// Points in the batch.
  std::size_t size() const { return size_; }
  /// Column `m` of contract().makes, 0 before the operator runs; T is the whole value, e.g. std::array<float, 3> or
  /// float, of Attribute::bytes() bytes: in what the engine makes, a type of another size throws UsageError, except
  /// std::byte.
  template <class T>
  std::span<T> column(std::size_t m) {
    assert(m < made_.size());
    if constexpr (!std::is_same_v<T, std::byte>)
      if (!bytes_.empty() && bytes_[m] != sizeof(T)) [[unlikely]]
        refuse_value_size(bytes_[m], sizeof(T));
    return {reinterpret_cast<T*>(made_[m]), size_};
  }
  /// False if column `m` is never read. An operator may then skip the work and leave the column unchanged.
  bool wanted(std::size_t m) const { return m >= unwanted_.size() || !unwanted_[m]; }
  /// Point i gets the documented value in place of a result, because its data define none. Statistics counts it.
  void mark_degenerate(std::size_t i);
  /// The points so marked, for the engine.
  DegeneratePoints& degenerate() { return *degenerate_; }

 private:
  std::span<std::byte* const> made_;
  std::size_t size_;
  DegeneratePoints* degenerate_;
  std::vector<bool> unwanted_;
  std::vector<std::size_t> bytes_;
};

/// A pure function of a point and its neighbourhood: the same input gives the same bytes, on any thread, at any time,
/// in any batch. It never queues, waits, counts references or keeps state between calls.
class POINTSWEEP_EXPORT Operator {
 public:
  virtual ~Operator() = default;
  /// As plans, statistics and the records in outputs call it.
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

  /// Of a select in order: a new one for one run over the cloud.
  virtual std::unique_ptr<Thinning> thinning(const ThinningSetup& setup) const {
    (void)setup;
    return nullptr;
  }
  /// Of a select in order with Contract::has_places: where a point with a finite position comes in the order. Called
  /// from many threads at once.
  virtual Vec3 place_of(Vec3 position) const { return position; }

  /// All that tells objects of this class apart. Name and options are part of what a run is: `resume_folder` refuses a
  /// run with other options, and outputs record them. Those that were declared, else own_options().
  Options declared_options() const { return declared_ ? *declared_ : own_options(); }
  /// The first call counts. Operators that pipelines name are made with the options that were written.
  void declare_options(Options options) {
    if (!declared_) declared_ = std::move(options);
  }

 protected:
  /// To be overridden by a class whose objects can differ, e.g. {{"width", width_}}.
  virtual Options own_options() const { return {}; }

 private:
  std::optional<Options> declared_;
};

/// An operator that takes the points of a batch one at a time. As fast as a batch where a point costs more than a
/// virtual call, about 2 ns.
class POINTSWEEP_EXPORT PointOperator : public Operator {
 public:
  void apply(const Neighborhoods& in, Columns& out) const final {
    for (std::size_t i = 0; i < in.size(); ++i) apply_to(i, in, out);
  }

 protected:
  /// Fills out.column(m)[i] for every made attribute m. Called from many threads at once.
  virtual void apply_to(std::size_t i, const Neighborhoods& in, Columns& out) const = 0;
};

}  // namespace pointsweep
