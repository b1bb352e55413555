// SPDX-License-Identifier: MIT
/// Sets of connected points: the signs of the points in them, their distance from a plane, and the side to which their
/// normals face.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// Disjoint sets of points (union-find). Each point also has a sign relative to the root of its set.
class JoinedSets {
 public:
  explicit JoinedSets(std::size_t count) : above_(count), flipped_(count), size_(count, 1) {
    std::iota(above_.begin(), above_.end(), 0u);
  }
  /// Returns the root of the set of i, and whether the signs of i and the root differ.
  std::pair<std::uint32_t, bool> root(std::uint32_t i) {
    bool flips = false;
    std::uint32_t top = i;
    for (; above_[top] != top; top = above_[top]) flips ^= flipped_[top];
    bool rest = flips;
    while (above_[i] != top && i != top) {
      const std::uint32_t next = above_[i];
      const bool own = flipped_[i];
      above_[i] = top, flipped_[i] = rest;
      rest ^= own;
      i = next;
    }
    return {top, flips};
  }
  /// Joins the sets of i and j. Returns false, without a change, if i and j were in one set. `signs_differ`: true if i
  /// and j have opposite signs.
  bool join(std::uint32_t i, std::uint32_t j, bool signs_differ = false) {
    auto [a, of_i] = root(i);
    auto [b, of_j] = root(j);
    if (a == b) return false;
    if (size_[a] < size_[b]) std::swap(a, b);
    above_[b] = a, flipped_[b] = of_i ^ of_j ^ signs_differ;
    size_[a] += size_[b];
    return true;
  }

 private:
  std::vector<std::uint32_t> above_;
  std::vector<bool> flipped_;
  std::vector<std::uint32_t> size_;
};

/// Numbers and sizes of sets of items (labels_of()). Items without a number have -1.
struct SetLabels {
  std::vector<std::int64_t> number;  ///< number of each item's set; sets are numbered in the order of their first items
  std::vector<std::uint64_t> size;   ///< number of points of the numbered items in each set
};

/// Returns the labels of `count` items, which are points or places. points_at(i): number of points of item i;
/// counts(i): true if item i gets a number.
template <class PointsAt, class Counts>
SetLabels labels_of(JoinedSets& sets, std::size_t count, PointsAt points_at, Counts counts) {
  SetLabels labels{std::vector<std::int64_t>(count, -1), {}};
  std::vector<std::int64_t> number_of_root(count, -1);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!counts(i)) continue;
    std::int64_t& number = number_of_root[sets.root(i).first];
    if (number < 0) number = static_cast<std::int64_t>(labels.size.size()), labels.size.push_back(0);
    labels.number[i] = number;
    labels.size[static_cast<std::size_t>(number)] += points_at(i);
  }
  return labels;
}

/// Measures the distance of points from their best-fitting plane. Takes the points twice: first for their centroid,
/// then for their covariance around it.
class Flatness {
 public:
  void measure(Vector p);
  void add(Vector p);

  /// Returns the root mean square distance of the points to their best-fitting plane, as float32; 0 for fewer than four
  /// points. The error bound covers the operator's rounding of coordinates to multiples of 2^-40, and 64 roundings of
  /// the mean squared distance from the centroid.
  Estimate residual() const;

 private:
  Real points_ = 0;
  Vector first_, sum_;  ///< first point, and the sum of offsets from it
  Matrix covariance_;   ///< covariance times the number of points
};

/// Decides whether the signs s of the normals n of a connected component are flipped. Takes the points of the component
/// twice: measure() for centroid and extent, then vote().
class TurningVotes {
 public:
  void measure(Vector p);
  void vote(Vector p, Vector signed_normal, const std::optional<Vector>& viewpoint);

  /// Returns whether all signs must be flipped; nothing if the data do not decide. Without a viewpoint, the larger in
  /// magnitude of Σ s n_z and Σ s n · (p - c) / e decides, with the centroid c and e the mean of the extents along x, y
  /// and z (the sum is 0 if e is 0); with a viewpoint v, Σ sign(s n · (v - p)) decides. Signs are flipped if the
  /// deciding sum is negative. The bound for a decision covers the operator's rounding of normals to multiples of
  /// 2^-20.
  std::optional<bool> turns(bool has_viewpoint) const;

 private:
  Real points_ = 0;
  Vector sum_, low_{kInfinity, kInfinity, kInfinity}, high_{-kInfinity, -kInfinity, -kInfinity};
  Real up_ = 0, out_ = 0, offsets_ = 0;  ///< `offsets_` is the sum of |x| + |y| + |z| over the vectors p - c
  Real facing_ = 0, in_doubt_ = 0;
};

}  // namespace pointsweep::formulas
