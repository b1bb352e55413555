// SPDX-License-Identifier: MIT
/// Distances between neighbouring points in each part of space, estimated from the sample of the survey (survey.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {

/// The local spacing of points, from an octree over the sample: a cube with fewer than 16 sample points is a leaf of
/// the octree, and the spacing in a leaf is proportional to its side. The leaf of a place off a surface is about as
/// wide as the distance to the surface, so outliers count as sparse. Far outside the box of the middle 98 % of the
/// sample, the distance to that box replaces the side. The spacing decides how slabs and cells are cut; no result
/// depends on it. The paper has no such structure, and names outliers as its major limitation (Section 8).
class LocalSpacing {
 public:
  /// Makes an empty object, for which no place is sparse.
  LocalSpacing() = default;
  /// `points` is the number of points of the cloud that the sample was taken from, `dimension` its intrinsic dimension.
  /// Takes about 13 ms for 65,536 sample points.
  LocalSpacing(std::span<const Vec3> sample, std::uint64_t points, double dimension);

  /// Encodes everything but at_sample(), which is empty in a decoded object.
  void encode(Encoder& out) const;
  static LocalSpacing decode(Decoder& in);

  /// Returns for each sample point an estimate of the distance between neighbouring points, in units of the
  /// coordinates, right within a factor of about two; empty if the sample has fewer than 16 points or no extent.
  const std::vector<double>& at_sample() const { return at_sample_; }
  /// Returns whether there are sparse places: whether the spacing at some sample points is at least 16 times the median
  /// spacing.
  bool has_sparse_places() const { return !begin_.empty(); }
  /// Returns whether a place is sparse. `p` must be finite. The answer depends only on the place. Takes about 10 ns.
  bool is_sparse(Vec3 p) const;

 private:
  struct Leaf {
    std::uint64_t begin;  ///< least code along the Z-curve (Morton code) in the leaf
    int level;            ///< the side of the leaf is the side of the root times 2^-level
  };
  static void grow(std::span<const std::uint64_t> codes, std::uint64_t begin, int level, std::vector<Leaf>& leaves);
  std::vector<int> levels_of(std::span<const Vec3> sample, const std::vector<Leaf>& leaves) const;
  void find_sparse_places(const std::vector<int>& levels, const std::vector<Leaf>& leaves);
  bool inside(Vec3 p) const;
  std::uint64_t index(Vec3 p, int axis) const;  ///< index of the finest cube that holds p
  std::uint64_t code_of(Vec3 p) const;
  int level_outside(Vec3 p) const;

  std::vector<double> at_sample_;
  Vec3 lo_;                        ///< corner of the root cube
  double side_ = 0;                ///< length of the side of the root cube
  std::int32_t sparse_level_ = 0;  ///< leaves of this level and coarser ones are sparse
  std::vector<std::uint64_t>
      begin_;  ///< first codes of the runs of leaves along the Z-curve, ascending; runs with an odd index are sparse
  std::vector<std::uint32_t> first_;  ///< for each value of the leading bits of a code: the index of the run that has
                                      ///< the first of these codes; one more entry at the end
  double inverse_side_ = 0;
};

}  // namespace pointsweep
