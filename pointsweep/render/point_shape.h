// SPDX-License-Identifier: MIT
/// The piece of surface that a point stands for: the best that its file allows. The distance between
/// neighbouring points at every place, estimated from a sample of the cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Halves the sample along its longest side until 16 points are left; of these the two longer sides of their box say
/// how much surface belongs to each, and their distances to each other whether they lie in rows or clumps with nothing
/// between. So dense and sparse parts of a scan get their own spacing. Memory and time to
/// build follow the sample, a look-up is one comparison for each halving.
class SpacingTree {
 public:
  /// `sample` stands for `points` points of a surface. No finite point: every spacing is 0.
  SpacingTree(std::vector<Vec3> sample, std::uint64_t points);

  /// Side of the square that one point of the cloud has to itself around `p`, at most twice the distance to the nearest
  /// other point that is usual there.
  double spacing(Vec3 p) const;

 private:
  struct Node {
    int axis = -1;  ///< -1: a leaf
    double split = 0;
    std::uint32_t above = 0;  ///< node of what is not below the split; what is below follows its parent
    double spacing = 0;
  };
  void build(std::size_t begin, std::size_t end, double share);

  std::vector<Vec3> sample_;
  std::vector<Node> nodes_;
};

/// An ellipse in space.
struct SurfaceElement {
  Vec3 u, v;    ///< semi-axes
  Vec3 normal;  ///< unit, or 0 where it is not known
};

/// Lengths.
struct DiscRadii {
  double largest_guess;  ///< of an estimated radius, so that the few points of a sparse place do not look like surface
  double fixed = 0;      ///< radius of every point, which then faces the viewer; 0: none
};

class PointShape {
 public:
  /// `right` and `up` span the plane of discs that face the viewer.
  PointShape(const Schema& schema, const SpacingTree& spacing, Vec3 right, Vec3 up, DiscRadii radii);

  bool has_normals() const { return !normal_.empty(); }

  /// The splat (normal, splat_x splat_y splat_z, splat_length, splat_ratio) where the file has one; else a disc across
  /// the normal, else one that faces the viewer, with the file's `radius`, or one that follows the spacing of the
  /// points around: 1.5 times as large on surfaces, which closes them, else as large.
  SurfaceElement operator()(const std::byte* record, Vec3 position) const;

 private:
  /// Fields of one attribute, empty if the file has not all of them.
  struct Fields : std::vector<Field> {
    Fields() = default;
    Fields(const Schema& schema, std::initializer_list<const char*> names);
  };
  static Vec3 vector_of(const Fields& fields, const std::byte* record);

  const SpacingTree& spacing_;
  Vec3 right_, up_;
  DiscRadii radii_;
  Fields normal_, axis_, size_, radius_;
};

}  // namespace pointsweep
