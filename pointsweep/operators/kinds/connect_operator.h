// SPDX-License-Identifier: MIT
/// Operators whose values come from the components of a graph of neighbours, and the attributes of operators that
/// number components.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/connect/forest_log.h"
#include "pointsweep/operator.h"

namespace pointsweep {

/// An edge between the point with the index `point` in a batch and one of its neighbours. `weight` and `flips` depend
/// on the two points alone: the neighbour, if it emits the edge too, computes the same bits.
struct NeighborEdge {
  std::uint32_t point;
  NeighborRef neighbor;
  double weight = 0;
  bool flips = false;  ///< true if the two points should have different signs
};

/// An operator that emits edges. The values of a point follow from the component of the point and from its sign in the
/// minimum spanning forest, which are known at the end of the pass (docs/adr/0014). A pass has at most one
/// ConnectOperator.
class ConnectOperator : public Operator {
 public:
  /// Returns whether edges have weights and flips; otherwise all edges are equal. With weights, put_values() may read
  /// only the `flips` of a label.
  virtual bool weighted() const { return false; }
  /// Returns the rule by which the points of a component vote. If null, every component gets a number, and no signs are
  /// turned.
  virtual const VoteRule* votes() const { return nullptr; }
  /// Appends the edges of the points of the batch, at most one for each neighbour. If votes() is not null, writes the
  /// ballot of point i to `ballots` + i * votes()->ballot_bytes(). Called from many threads at once.
  virtual void connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte* ballots) const = 0;
  /// Writes the values of a point for all attributes that the operator makes, one after another.
  virtual void put_values(const ComponentLabel& label, std::byte* values) const = 0;
  /// Returns the operator for a cloud with the fields of `input` after stages that make `made`; see
  /// LocalOperator::bound().
  virtual std::shared_ptr<const ConnectOperator> bound(const Schema& input, std::span<const Attribute> made) const {
    (void)input, (void)made;
    return nullptr;
  }
};

/// Returns whether component numbers and sizes have 32 bits in a cloud of `points` points; false for 0, which means
/// that the number of points is unknown.
inline bool has_short_numbers(std::uint64_t points) { return points > 0 && points < std::uint64_t{1} << 31; }

/// Returns the attribute `name`, N i32 or i64: the number of the component of a point; -1 if it has none.
inline Attribute component_number(const std::string& name, std::string meaning, std::uint64_t points) {
  const Type type = has_short_numbers(points) ? Type::i32 : Type::i64;
  return {name, type, Kind::index, {name}, "1", std::move(meaning), std::byte{0xff}};
}

/// Returns the attribute `name`, one uint32 or uint64 per point: the number of points in the component of a point.
inline Attribute component_size(std::string name, std::string meaning, std::uint64_t points) {
  return scalar(std::move(name), has_short_numbers(points) ? Type::u32 : Type::u64, "1", std::move(meaning));
}

/// The types of component_number() and component_size(), for docs/attributes.md.
inline constexpr const char *kNumberTypes = "i32, i64 from 2³¹ rows on", *kSizeTypes = "u32, u64 from 2³¹ rows on";

/// Writes the number and the size of a component to `values`: 32 bits each if `is_short`, else 64 bits each.
inline void put_component(const ComponentLabel& label, bool is_short, std::byte* values) {
  const auto put = [&](auto number, auto size) {
    std::memcpy(values, &number, sizeof number);
    std::memcpy(values + sizeof number, &size, sizeof size);
  };
  if (is_short)
    put(static_cast<std::uint32_t>(label.number), static_cast<std::uint32_t>(label.points));
  else
    put(label.number, label.points);
}

}  // namespace pointsweep
