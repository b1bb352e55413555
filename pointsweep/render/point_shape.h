// SPDX-License-Identifier: MIT
/// The piece of surface that represents a point in a picture, from the attributes that the file has, and the local
/// spacing of points, estimated from a sample of the cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Estimates the local spacing of points. Halves the sample along its longest side until each part has at most 16
/// points or all its points at one place. The two longer sides of the box of a part give the area per point, and the
/// distances between its points show whether they lie in rows or clumps with gaps. Memory and time to build are
/// proportional to the sample; a look-up takes one comparison per halving.
class SpacingTree {
 public:
  /// Builds the tree of a sample of finite points. `points`: number of points of the cloud, of which the sample is a
  /// part. The spacing is 0 in a part with one point or with all points at one place, and for an empty sample.
  SpacingTree(std::vector<Vec3> sample, std::uint64_t points);

  /// Returns the side of the square that one point of the cloud occupies around `p`, at most twice the typical distance
  /// to the nearest other point there.
  double spacing(Vec3 p) const;

 private:
  struct Node {
    int axis = -1;  ///< axis of the split; -1 for a leaf
    double split = 0;
    std::uint32_t above = 0;  ///< node of the points not below the split; the other child follows its parent
    double spacing = 0;
  };
  void build(std::size_t begin, std::size_t end, double share);

  std::vector<Vec3> sample_;
  std::vector<Node> nodes_;
};

/// An ellipse in space.
struct SurfaceElement {
  Vec3 u, v;    ///< semi-axes of the ellipse
  Vec3 normal;  ///< unit vector, or 0 if the normal is unknown
};

/// Radii of discs, in the unit of the cloud.
struct DiscRadii {
  /// Limit of estimated radii, so that the few points of a sparse place do not look like a surface.
  double largest_guess;
  double fixed = 0;  ///< if above 0, all points are discs of this radius that face the viewer
};

/// Chooses the disc or ellipse that is drawn for a point.
class PointShape {
 public:
  /// `right` and `up` span the plane of discs that face the viewer. `spacing` must outlive the PointShape.
  PointShape(const Schema& schema, const SpacingTree& spacing, Vec3 right, Vec3 up, DiscRadii radii);

  bool has_normals() const { return !normal_.empty(); }

  /// If DiscRadii::fixed is above 0, returns a disc of this radius that faces the viewer. Else returns the splat of the
  /// point if it has a valid one; else a disc, perpendicular to the normal, or facing the viewer if the point has no
  /// normal. The radius of the disc is the field `radius` if its value is positive, else the smaller of
  /// DiscRadii::largest_guess and the local spacing (times 1.5 with a normal, which closes gaps).
  SurfaceElement operator()(const std::byte* record, Vec3 position) const;

 private:
  /// The fields of one attribute; empty if the file lacks one of them.
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
