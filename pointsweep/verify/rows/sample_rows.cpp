// SPDX-License-Identifier: MIT
/// The random sample of rows for a check, and the places of given rows in an output in the order of a sweep.
#include <algorithm>
#include <array>
#include <numeric>
#include <unordered_set>

#include "pointsweep/math/mix.h"
#include "pointsweep/verify/rows/row_alignment.h"

namespace pointsweep {
namespace {

struct PlaceInOrder {
  bool nonfinite;
  std::array<double, 4> key;  ///< coordinate on the axis, x, y, z
  std::uint64_t row;

  friend bool operator<(const PlaceInOrder& a, const PlaceInOrder& b) {
    if (a.nonfinite != b.nonfinite) return b.nonfinite;
    if (!a.nonfinite && a.key != b.key) return a.key < b.key;
    return a.row < b.row;
  }
};

PlaceInOrder place_of(Vec3 p, std::uint64_t row, int axis) { return {!is_finite(p), {p[axis], p.x, p.y, p.z}, row}; }

}  // namespace

std::vector<std::uint64_t> sample_rows(std::uint64_t count, std::uint64_t size, std::uint64_t seed) {
  std::vector<std::uint64_t> rows;
  if (size >= count) {
    rows.resize(count);
    std::iota(rows.begin(), rows.end(), std::uint64_t{0});
    return rows;
  }
  // Floyd's algorithm (Bentley and Floyd, "A sample of brilliance", 1987): one draw for each row that is chosen.
  std::unordered_set<std::uint64_t> chosen;
  for (std::uint64_t last = count - size; last < count; ++last) {
    const std::uint64_t draw = mix(mix(seed) ^ last) % (last + 1);
    if (!chosen.insert(draw).second) chosen.insert(last);
  }
  rows.assign(chosen.begin(), chosen.end());
  std::sort(rows.begin(), rows.end());
  return rows;
}

std::vector<std::uint64_t> sweep_rows(RowSource& in, std::span<const std::uint64_t> rows, int axis,
                                      const PhaseProgress& progress) {
  const PositionFields position = position_fields(in.schema(), in.name());
  std::vector<PlaceInOrder> places(rows.size());
  for_each_record(in, rows, [&](std::size_t i, const std::byte* record) {
    places[i] = place_of({value_of(position.x, record), value_of(position.y, record), value_of(position.z, record)},
                         rows[i], axis);
  });
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return places[a] < places[b]; });
  std::vector<PlaceInOrder> sorted;
  for (const std::size_t i : order) sorted.push_back(places[i]);

  // Counts the points between successive chosen points.
  std::vector<std::uint64_t> between(rows.size() + 1);
  for_each_position(in, "ordering", progress, [&](std::uint64_t row, Vec3 p) {
    ++between[std::upper_bound(sorted.begin(), sorted.end(), place_of(p, row, axis)) - sorted.begin()];
  });
  std::vector<std::uint64_t> ranks(rows.size());
  std::uint64_t before = 0;
  for (std::size_t s = 0; s < order.size(); ++s) ranks[order[s]] = before += between[s];
  // A chosen point is counted after itself, so its rank includes the chosen points before it.
  return ranks;
}

}  // namespace pointsweep
