// SPDX-License-Identifier: MIT
/// Chosen points with their neighbours, the neighbours' neighbours, and so on as far as a chain of operators needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/verify/rows/row_source.h"
#include "pointsweep/verify/search/nearest_in_stream.h"

namespace pointsweep {

/// The rule for neighbours: the k nearest other points within `radius` (inclusive); all other points within `radius`
/// without a limit k.
struct NeighborRule {
  static constexpr std::size_t kUnlimited = NearestInStream::kAll;
  std::size_t k = 8;
  double radius = std::numeric_limits<double>::infinity();
};

/// Chosen points with their neighbours, numbered ring by ring: first the chosen points, then their neighbours that were
/// not chosen, and so on. All points except those of the last ring have lists of neighbours.
struct Surroundings {
  std::vector<double> x, y, z;
  std::vector<std::uint64_t> row;
  std::vector<std::size_t> ring_end;     ///< for each ring r, number of points in the rings up to r
  std::vector<std::size_t> list_begin;   ///< begin of each point's list in `neighbors`, and the end of the last list
  std::vector<std::uint32_t> neighbors;  ///< numbers of points, nearest first

  std::size_t size() const { return row.size(); }
  Vec3 position(std::size_t i) const { return {x[i], y[i], z[i]}; }
  /// Adds a point without a list, and returns its number.
  std::uint32_t add(Vec3 p, std::uint64_t of_row) {
    x.push_back(p.x), y.push_back(p.y), z.push_back(p.z), row.push_back(of_row);
    return static_cast<std::uint32_t>(row.size() - 1);
  }
};

/// Returns the chosen points with `rings` (1 or more) rings of neighbours. Reads the whole input once for each ring.
/// `subset`: a random or evenly spaced sample of the input, which bounds the distances of neighbours.
Surroundings find_surroundings(RowSource& in, std::span<const KnownPoint> chosen, std::span<const KnownPoint> subset,
                               const NeighborRule& rule, std::size_t rings, const PhaseProgress& progress);

}  // namespace pointsweep
