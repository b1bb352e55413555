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
#include <ranges>
#include <span>
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

/// A view of the coordinates of N points: an array of 3 N floats or doubles with x, y and z of a point side by side, or
/// an array of N arrays of three numbers. Borrows the array.
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

  /// Returns the number of rows: the number of points, or fewer if a stage or RunOptions::nonfinite drops rows.
  std::size_t size() const { return records_.size() / schema_.stride; }
  const Statistics& statistics() const { return statistics_; }

  /// Returns the values of a field ("k1", "nx", "x"), or of an attribute with m values ("normal") as T = std::array<U,
  /// m>, by row. Throws UsageError if no result has this name, and if T does not match the type of the values.
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
  /// Copies the values of the result `name` to `out`: `bytes` for each row, of the type `type`.
  void copy(std::string_view name, Type type, std::size_t bytes, std::byte* out) const;

  Schema schema_;
  std::vector<Attribute> made_;
  std::vector<std::byte> records_;
  Statistics statistics_;
};

/// Runs `chain` over points in an array. The results have the same bytes as the results that run() writes to files.
/// Throws the errors of run() for a Cloud.
POINTSWEEP_EXPORT ArrayResults run(PointsView points, const Chain& chain, const RunOptions& options = {});

/// Returns the unit normal of each point, by row; (0, 0, 0) if it is undefined. The default neighbourhood is the
/// default of `pointsweep normals`. Throws the errors of run().
POINTSWEEP_EXPORT std::vector<std::array<float, 3>> normals(PointsView xyz, const NormalsOptions& options = {},
                                                            const Neighborhood& neighborhood = {
                                                                .k = Neighborhood::kOfOperators});

}  // namespace pointsweep
