// SPDX-License-Identifier: MIT
/// Points and results in arrays, without files, readers and writers.
///
///   const std::vector<std::array<float, 3>> unit = normals(xyz, {.orient = Orient::up});
///   const ArrayResults results = run(xyz, {.stages = {operators::normals(), operators::curvature()}});
///   const std::vector<float> k1 = results.get<float>("k1");
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/chain.h"
#include "pointsweep/export.h"
#include "pointsweep/operators.h"
#include "pointsweep/run.h"
#include "pointsweep/statistics.h"

namespace pointsweep {

/// Coordinates of points: N×3 floats or doubles, x, y and z of a point side by side, or N arrays of three. The array is
/// borrowed.
class PointsView {
 public:
  template <std::ranges::contiguous_range Range>
  requires std::same_as < std::ranges::range_value_t<Range>,
  float > || std::same_as<std::ranges::range_value_t<Range>, double> PointsView(const Range& xyz)
      : xyz_(std::span(std::ranges::data(xyz), std::ranges::size(xyz))) {}

  template <std::ranges::contiguous_range Range>
  requires std::same_as<std::ranges::range_value_t<Range>, std::array<float, 3>> ||
      std::same_as<std::ranges::range_value_t<Range>, std::array<double, 3>>
      PointsView(const Range& points) {
    using Coordinate = typename std::ranges::range_value_t<Range>::value_type;
    const std::size_t n = std::ranges::size(points);
    xyz_ = n == 0 ? std::span<const Coordinate>() : std::span(std::ranges::data(points)->data(), 3 * n);
  }

  using Coordinates = std::variant<std::span<const float>, std::span<const double>>;
  const Coordinates& xyz() const { return xyz_; }

 private:
  Coordinates xyz_;
};

/// Results of a run in memory: the positions, and the attributes that the chain makes or Chain::keep names.
class POINTSWEEP_EXPORT ArrayResults {
 public:
  /// Takes `records` in the layout of `schema`, and the attributes that the chain has made.
  ArrayResults(Schema schema, std::vector<Attribute> made, std::vector<std::byte> records, Statistics statistics)
      : schema_(std::move(schema)),
        made_(std::move(made)),
        records_(std::move(records)),
        statistics_(std::move(statistics)) {}

  /// Returns the number of rows: the number of points, or fewer after a select.
  std::size_t size() const { return records_.size() / schema_.stride; }
  const Statistics& statistics() const { return statistics_; }

  /// Copies a field ("k1", "nx", "x"), or an attribute of m values as T = std::array<U, m> ("normal"). Throws
  /// UsageError for a name that is not among the results, and for another type than theirs.
  template <class T>
  std::vector<T> get(std::string_view name) const {
    std::vector<T> values(size());
    copy(name, element_type<T>(), sizeof(T), reinterpret_cast<std::byte*>(values.data()));
    return values;
  }

 private:
  template <class T>
  static constexpr Type element_type() {
    if constexpr (std::is_arithmetic_v<T>) {
      constexpr std::size_t kWidth = sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 1 : sizeof(T) == 4 ? 2 : 3;
      constexpr Type kSigned[] = {Type::i8, Type::i16, Type::i32, Type::i64};
      constexpr Type kUnsigned[] = {Type::u8, Type::u16, Type::u32, Type::u64};
      if constexpr (std::is_floating_point_v<T>) return sizeof(T) == 4 ? Type::f32 : Type::f64;
      return (std::is_signed_v<T> ? kSigned : kUnsigned)[kWidth];
    } else {
      return element_type<typename T::value_type>();
    }
  }
  /// Copies `bytes` of each row, values of `type`, to `out`.
  void copy(std::string_view name, Type type, std::size_t bytes, std::byte* out) const;

  Schema schema_;
  std::vector<Attribute> made_;
  std::vector<std::byte> records_;
  Statistics statistics_;
};

/// Runs `chain` over points in an array. The results have the same bytes as those of run() to files. Throws like run().
POINTSWEEP_EXPORT ArrayResults run(PointsView points, const Chain& chain, const RunOptions& options = {});

/// Returns the unit normals of the points, by row; (0, 0, 0) where undefined. The default neighbourhood is that of
/// `pointsweep normals`. Throws like run().
POINTSWEEP_EXPORT std::vector<std::array<float, 3>> normals(PointsView xyz, const NormalsOptions& options = {},
                                                            const Neighborhood& neighborhood = {
                                                                .k = Neighborhood::kOfOperators});

}  // namespace pointsweep
