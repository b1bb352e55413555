// SPDX-License-Identifier: MIT
#include "pointsweep/operators/statistics/neighbor_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>

#include "pointsweep/fail.h"
#include "pointsweep/operators.h"
#include "pointsweep/program/declaration.h"

namespace pointsweep {
namespace {

/// The indices of the k nearest neighbours in the list of a point, nearest first at the current positions: by distance,
/// then x, y, z and row. Neighbours without a finite place come last, by row.
class NearestPlaces {
 public:
  NearestPlaces(const Neighborhoods& in, std::size_t k) : in_(in), k_(k) {}
  /// Finds the nearest neighbours of point i. Returns their number.
  std::size_t find(std::size_t i) {
    const std::size_t count = in_.count(i), kept = std::min(count, k_);
    if (in_.sorted_by_distance()) return kept;
    ranked_.clear();
    for (std::size_t j = 0; j < count; ++j) ranked_.push_back(rank(i, j));
    std::partial_sort(ranked_.begin(), ranked_.begin() + static_cast<std::ptrdiff_t>(kept), ranked_.end());
    return kept;
  }
  std::size_t operator[](std::size_t j) const { return in_.sorted_by_distance() ? j : ranked_[j].place; }

 private:
  struct Ranked {
    double distance2;
    Vec3 position;
    std::uint64_t row;
    std::size_t place;

    auto key() const { return std::tie(distance2, position.x, position.y, position.z, row); }
    bool operator<(const Ranked& other) const { return key() < other.key(); }
  };
  Ranked rank(std::size_t i, std::size_t j) const {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    const Vec3 position = in_.neighbor_position(i, j);
    const double distance2 = in_.distance2(i, j);
    if (!is_finite(position) || std::isnan(distance2)) return {kInf, {kInf, kInf, kInf}, in_.neighbor_row(i, j), j};
    return {distance2, position, in_.neighbor_row(i, j), j};
  }

  const Neighborhoods& in_;
  std::size_t k_;
  std::vector<Ranked> ranked_;
};

std::vector<std::string> numbered(const std::string& name, std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.push_back(name + "_" + std::to_string(i));
  return names;
}
}  // namespace

OperatorDeclaration neighbor_rows_declaration() {
  return {
      .name = "neighbors",
      .meaning = "rows of the neighbours, nearest first, and their distances",
      .options = {{.name = "k",
                   .kind = OptionKind::whole,
                   .preset = std::uint64_t{16},
                   .meaning = "number of columns, at least the number of neighbours",
                   .least = 1}},
      .make = [](const OptionValues& options,
                 const Facts& facts) { return std::make_shared<NeighborRows>(options.whole("k"), facts.points, true); },
      .formula =
          "Row i holds the rows of N_i by distance; equal distances by x, y, z, then by row. Rows are those of "
          "the input, or, after stages that drop points, those that are left.",
      .undefined =
          "Where a point has fewer than k neighbours, the rest of its row is the largest value of the type, and "
          "NaN in the distances.",
      .attributes = {{.name = "neighbors",
                      .meaning = "rows of the neighbours, nearest first at the positions the stage sees; "
                                 "missing: largest value of the type",
                      .type = "u32, u64 from 2³² - 1 rows on",
                      .shape = "N×k"},
                     {.name = "distances", .meaning = "distances to these neighbours; missing: NaN", .shape = "N×k"}}};
}

ChainStage operators::neighbors(std::size_t k, std::uint64_t points, bool distances) {
  if (k == 0) fail_usage("neighbors: k is a whole number, 1 or more, not '0'.");
  return std::make_shared<NeighborRows>(k, points, distances);
}

NeighborRows::NeighborRows(std::size_t k, std::uint64_t rows, bool distances)
    : k_(k), wide_(rows >= std::numeric_limits<std::uint32_t>::max()), distances_(distances) {
  declare_options({{"k", std::uint64_t{k}}, {"distances", std::string(distances ? "true" : "false")}});
}

Contract NeighborRows::contract() const {
  Contract c;
  c.makes.push_back({"neighbors", wide_ ? Type::u64 : Type::u32, Kind::index, numbered("neighbor", k_), "",
                     "input rows of the k nearest neighbours, nearest first", std::byte{0xFF}});
  if (distances_) {
    c.makes.push_back({"distances", Type::f64, Kind::scalar, numbered("distance", k_), "length",
                       "distances to the k nearest neighbours", std::byte{0xFF}});
  }
  return c;
}

template <class Row>
void NeighborRows::write(const Neighborhoods& in, Row* row, double* distance) const {
  NearestPlaces nearest(in, k_);
  for (std::size_t i = 0; i < in.size(); ++i, row += k_) {
    const std::size_t found = nearest.find(i);
    for (std::size_t j = 0; j < found; ++j) row[j] = static_cast<Row>(in.neighbor_row(i, nearest[j]));
    std::fill(row + found, row + k_, std::numeric_limits<Row>::max());
    if (distance == nullptr) continue;
    for (std::size_t j = 0; j < found; ++j) distance[j] = std::sqrt(in.distance2(i, nearest[j]));
    std::fill(distance + found, distance + k_, std::numeric_limits<double>::quiet_NaN());
    distance += k_;
  }
}

void NeighborRows::apply(const Neighborhoods& in, Columns& out) const {
  // A column has k values for each point.
  auto* const distance = distances_ ? reinterpret_cast<double*>(out.column<std::byte>(1).data()) : nullptr;
  std::byte* const rows = out.column<std::byte>(0).data();
  if (wide_) {
    write(in, reinterpret_cast<std::uint64_t*>(rows), distance);
  } else {
    write(in, reinterpret_cast<std::uint32_t*>(rows), distance);
  }
}

}  // namespace pointsweep
