// SPDX-License-Identifier: MIT
/// The definition of neighbourhoods, and batches of points with their neighbourhoods N_i for operators.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/export.h"
#include "pointsweep/geometry.h"
#include "pointsweep/option.h"

namespace pointsweep {

class NeighborhoodRule;

/// A rule that several neighbourhoods may share, or no rule. It is a shared pointer whose destructor is not inlined:
/// with an inlined destructor, GCC 12 wrongly warns of an uninitialized object if a chain is written in braces.
class POINTSWEEP_EXPORT SharedRule {
 public:
  SharedRule() = default;
  template <class Rule>
  SharedRule(std::shared_ptr<Rule> rule) : rule_(std::move(rule)) {}
  SharedRule(const SharedRule&) = default;
  SharedRule& operator=(const SharedRule&) = default;
  ~SharedRule();

  explicit operator bool() const { return rule_ != nullptr; }
  const NeighborhoodRule* operator->() const { return rule_.get(); }
  const NeighborhoodRule& operator*() const { return *rule_; }

 private:
  std::shared_ptr<const NeighborhoodRule> rule_;
};

/// The definition of a neighbourhood: the `k` nearest points within `radius` (inclusive), the point itself excluded; k
/// may be unlimited, and the radius infinite. A rule shortens this list. Neighbourhoods are exact: distances are
/// evaluated in double at the positions of the search, and equal distances are ordered by x, y, z, then input row.
struct Neighborhood {
  static constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();
  /// Stands for the default of the operators of a chain: their largest Contract::default_k, or all points within their
  /// largest Contract::all_within.
  static constexpr std::size_t kOfOperators = kUnlimited - 1;
  std::size_t k = 8;  ///< number of points, 1 or more; kUnlimited for all points within the radius
  double radius = std::numeric_limits<double>::infinity();  ///< radius in the length unit of the cloud, above 0
  SharedRule rule = {};

  double radius2() const { return radius * radius; }
};

/// Number of bits of the index of a point in its cell. A NeighborRef names a point by the slot of its cell, which is
/// the number of a place for a cell in memory, and by its index in the cell. Of Neighborhoods, only values_of_slot()
/// shows this memory layout to operators.
inline constexpr std::uint32_t kIndexBits = 11;
inline constexpr std::uint32_t kCellCapacity = 1u << kIndexBits;
using NeighborRef = std::uint32_t;  ///< slot << kIndexBits | index; valid as long as the batch
inline NeighborRef make_ref(std::uint32_t slot, std::uint32_t index) { return slot << kIndexBits | index; }
inline std::uint32_t slot_of(NeighborRef ref) { return ref >> kIndexBits; }
inline std::uint32_t index_of(NeighborRef ref) { return ref & (kCellCapacity - 1); }

/// The points of one slot as a structure of arrays, which the engine owns.
struct PointColumns {
  const double* x = nullptr;  ///< coordinates as in the input, in the length unit of the file
  const double* y = nullptr;
  const double* z = nullptr;
  const std::uint64_t* row = nullptr;         ///< rows in the input
  const std::byte* const* columns = nullptr;  ///< values of each column of the plan
};

/// Throws the UsageError for an operator that has asked for `asked` bytes of a value that has `bytes`.
[[noreturn]] POINTSWEEP_EXPORT void refuse_value_size(std::size_t bytes, std::size_t asked);

/// A batch of at most kCellCapacity points, each with its neighbours, the point itself excluded. Valid only during the
/// call of the operator or rule that gets it.
///
/// The list of a point is in the ORDER OF THE SEARCH: nearest first, equal distances by x, y, z and input row. This
/// order refers to the positions at which the search found the neighbours: the positions in the input, or at the last
/// `reneighbor`. Positions in this class are the current positions. After an operator that moves points, without
/// `reneighbor`, N_i is the same set, but distances along a list are not sorted: the last neighbour need not be the
/// farthest, the first not the nearest, and any neighbour may coincide with p_i or have coordinates that are not
/// finite. For a least or greatest distance, read all of N_i unless sorted_by_distance(), or call farthest_distance2().
class Neighborhoods {
 public:
  /// Makes a batch for the engine. `position_column`: number of the column of moved positions, which replace the
  /// positions of the search; negative if there is none. `moved`: true if the positions in `own` and `slots` have been
  /// moved. `column_bytes`: bytes of a value of each column; null if types are not checked.
  Neighborhoods(const PointColumns& own, std::size_t size, const PointColumns* slots, const std::uint32_t* begin,
                const NeighborRef* refs, std::span<const std::uint16_t> reads,
                std::span<const std::uint16_t> reads_neighbors, int position_column = -1, bool moved = false,
                const std::uint32_t* column_bytes = nullptr)
      : own_(own),
        size_(size),
        slots_(slots),
        begin_(begin),
        refs_(refs),
        reads_(reads),
        reads_neighbors_(reads_neighbors),
        column_bytes_(column_bytes),
        position_column_(position_column),
        sorted_by_distance_(position_column < 0 && !moved) {}

  std::size_t size() const { return size_; }
  Vec3 position(std::size_t i) const { return position_in(own_, i); }
  std::uint64_t row(std::size_t i) const { return own_.row[i]; }
  /// Returns |N_i|, the number of neighbours of point i.
  std::size_t count(std::size_t i) const { return begin_[i + 1] - begin_[i]; }

  /// Returns whether positions are the positions of the search, so that distance2(i, j) never decreases as j grows.
  bool sorted_by_distance() const { return sorted_by_distance_; }
  /// Returns max_j |p_j - p_i|² over N_i at the current positions; 0 without neighbours, NaN or infinite if a neighbour
  /// has non-finite coordinates.
  double farthest_distance2(std::size_t i) const {
    const std::size_t n = count(i);
    if (n == 0) return 0;
    if (sorted_by_distance_) return distance2(i, n - 1);
    double farthest2 = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const double d2 = distance2(i, j);
      if (d2 != d2) return d2;
      farthest2 = d2 > farthest2 ? d2 : farthest2;
    }
    return farthest2;
  }

  /// Returns N_i in the order of the search, for loops over many neighbours.
  const NeighborRef* neighbors(std::size_t i) const { return refs_ + begin_[i]; }
  Vec3 position_of(NeighborRef ref) const { return position_in(slots_[slot_of(ref)], index_of(ref)); }
  Vec3 neighbor_position(std::size_t i, std::size_t j) const { return position_of(neighbors(i)[j]); }
  /// Returns p_j - p_i: one subtraction in double for each coordinate.
  Vec3 offset(std::size_t i, std::size_t j) const { return neighbor_position(i, j) - position(i); }
  double distance2(std::size_t i, std::size_t j) const {
    return pointsweep::distance2(neighbor_position(i, j), position(i));
  }
  std::uint64_t neighbor_row(std::size_t i, std::size_t j) const {
    const NeighborRef ref = refs_[begin_[i] + j];
    return slots_[slot_of(ref)].row[index_of(ref)];
  }

  /// Returns attribute `a` of the operator's contract().reads at point i. T is the whole value, e.g. std::array<float,
  /// 3>. If the engine made the batch, a type of another size throws UsageError.
  template <class T>
  T value(std::size_t a, std::size_t i) const {
    require_size<T>(reads_[a]);
    return load<T>(own_.columns[reads_[a]], i);
  }
  /// Returns attribute `a` of contract().reads of all points of the batch; std::byte is allowed as T for any type.
  template <class T>
  const T* values(std::size_t a) const {
    if constexpr (!std::is_same_v<T, std::byte>) require_size<T>(reads_[a]);
    return reinterpret_cast<const T*>(own_.columns[reads_[a]]);
  }
  /// Returns attribute `a` of the operator's contract().reads_neighbors at the j-th neighbour of point i.
  template <class T>
  T neighbor_value(std::size_t a, std::size_t i, std::size_t j) const {
    return value_of<T>(a, neighbors(i)[j]);
  }
  /// Returns attribute `a` of contract().reads_neighbors of all points of a slot, indexed by index_of(); std::byte is
  /// allowed as T for any type.
  template <class T>
  const T* values_of_slot(std::size_t a, std::uint32_t slot) const {
    if constexpr (!std::is_same_v<T, std::byte>) require_size<T>(reads_neighbors_[a]);
    return reinterpret_cast<const T*>(slots_[slot].columns[reads_neighbors_[a]]);
  }
  /// Returns attribute `a` of contract().reads_neighbors at any neighbour of the batch.
  template <class T>
  T value_of(std::size_t a, NeighborRef ref) const {
    require_size<T>(reads_neighbors_[a]);
    return load<T>(slots_[slot_of(ref)].columns[reads_neighbors_[a]], index_of(ref));
  }
  /// Returns attribute `a`, which has three floats, as a vector: vector() for point i, vector_of() for a neighbour.
  Vec3 vector(std::size_t a, std::size_t i) const {
    require_size<std::array<float, 3>>(reads_[a]);
    return load_vector(own_.columns[reads_[a]], i);
  }
  Vec3 vector_of(std::size_t a, NeighborRef ref) const {
    require_size<std::array<float, 3>>(reads_neighbors_[a]);
    return load_vector(slots_[slot_of(ref)].columns[reads_neighbors_[a]], index_of(ref));
  }

 private:
  template <class T>
  void require_size(std::uint16_t column) const {
    if (column_bytes_ != nullptr && column_bytes_[column] != sizeof(T)) [[unlikely]]
      refuse_value_size(column_bytes_[column], sizeof(T));
  }
  Vec3 position_in(const PointColumns& c, std::size_t i) const {
    if (position_column_ < 0) return {c.x[i], c.y[i], c.z[i]};
    const auto p = load<std::array<double, 3>>(c.columns[position_column_], i);
    return {p[0], p[1], p[2]};
  }
  template <class T>
  static T load(const std::byte* column, std::size_t i) {
    T v;
    std::memcpy(&v, column + i * sizeof(T), sizeof(T));
    return v;
  }

  /// Loads one float at a time, since a copy of the whole struct would go through memory.
  static Vec3 load_vector(const std::byte* column, std::size_t i) {
    return {load<float>(column, 3 * i), load<float>(column, 3 * i + 1), load<float>(column, 3 * i + 2)};
  }

  PointColumns own_;
  std::size_t size_;
  const PointColumns* slots_;
  const std::uint32_t* begin_;
  const NeighborRef* refs_;
  std::span<const std::uint16_t> reads_, reads_neighbors_;
  const std::uint32_t* column_bytes_;
  int position_column_;
  bool sorted_by_distance_;
};

/// A rule that chooses the size of the neighbourhood of each point. The search finds the largest neighbourhood that any
/// point may have, nearest first. The rule chooses a number m for the point and keeps its first m neighbours. The kept
/// neighbours are exact because the list is exact: the first m of the k nearest neighbours are the m nearest.
///
/// Like an operator, a rule is a pure function of a point, its attributes and its list. It runs once per point, before
/// all stages. The search costs as much as for the largest neighbourhood.
class POINTSWEEP_EXPORT NeighborhoodRule {
 public:
  virtual ~NeighborhoodRule() = default;
  /// Returns a phrase for the neighbours that the rule keeps: "the first 10 or more with the least eigenentropy".
  virtual std::string meaning() const = 0;
  /// Returns the attributes of the point itself that the rule reads, which must be fields of the input.
  virtual std::vector<Attribute> reads() const = 0;
  /// Returns the options that distinguish rules of one class, e.g. {{"k_from", "scale"}}. They are part of the identity
  /// of a run.
  virtual Options options() const { return {}; }
  /// Sets counts[i] to the number of neighbours that point i keeps, at most in.count(i). Called from many threads at
  /// once.
  virtual void choose(const Neighborhoods& in, std::span<std::uint32_t> counts) const = 0;
};

}  // namespace pointsweep
