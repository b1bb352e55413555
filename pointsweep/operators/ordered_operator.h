// SPDX-License-Identifier: MIT
/// Operators whose values come from all points in an order along an axis: rasters, searches in the plane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// Values of what an OrderedOperator makes, those of one row after those of another, and the rows they belong to.
struct MadeInOrder {
  std::vector<std::uint64_t> rows;
  std::vector<std::byte> values;
};

/// Takes all points in order, several times. Its values depend only on the set of points, not on how they are divided
/// into calls, nor on the axis.
class OrderedWork {
 public:
  virtual ~OrderedWork() = default;
  /// How many times the points come.
  virtual unsigned rounds() const = 0;
  /// The next points of round `round`, which counts from 0. Appends values that are known; each row gets one, those
  /// that get none have the fill of the attribute.
  virtual void add(unsigned round, const OrderedPoints& points, MadeInOrder& made) = 0;
  /// After the last point of a round.
  virtual void end(unsigned round, MadeInOrder& made) = 0;
};

/// Gives all finite points of another cloud, in ascending order along the axis.
using OtherPoints = std::function<void(
    const std::function<void(std::span<const Vec3> positions, std::span<const std::uint64_t> rows)>& take)>;

struct OrderedSetup {
  int axis = 0;                    ///< along which places ascend: 0 or 1 if in_plane(), else any
  std::uint64_t memory_bytes = 0;  ///< that it may hold
  MakeScratch make_scratch;
  OtherPoints other_points = {};  ///< of OrderedOperator::other_cloud()
};

/// An operator that takes all points in order and makes attributes. It is alone, has places and does not select. All
/// its attributes share one fill byte.
class OrderedOperator : public Operator {
 public:
  virtual std::unique_ptr<OrderedWork> work(const OrderedSetup& setup) const = 0;
  /// Returns whether the places of all points have z = 0. Such points cannot come in order along z.
  virtual bool in_plane() const { return false; }
  /// The name of the files of another cloud that it reads, as an input of a command names them; empty: it reads none.
  virtual std::string other_cloud() const { return {}; }
  /// The least memory of a work on a cloud with this sample of positions, along this axis.
  virtual std::uint64_t least_bytes(std::span<const Vec3> sample, int axis) const = 0;
  /// Never called.
  void apply(const Neighborhoods&, Columns&) const override {}
};

}  // namespace pointsweep
