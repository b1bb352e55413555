// SPDX-License-Identifier: MIT
#include "pointsweep/operators/normals.h"

#include <array>
#include <cstddef>
#include <span>

#include "pointsweep/error.h"
#include "pointsweep/operators/normals_kernel.h"

namespace pointsweep {
namespace {

using Normal = std::array<float, 3>;

/// Adding 0 turns -0 into 0, so that no output shows which way a component was flipped.
Normal flipped(Normal n) { return {0.0f - n[0], 0.0f - n[1], 0.0f - n[2]}; }

double dot(Normal n, Vec3 v) { return pointsweep::dot({n[0], n[1], n[2]}, v); }

/// Negative: the normal is to be turned round.
double along_wanted(const NormalsOptions& options, const Neighborhoods& in, std::size_t i, Normal n) {
  switch (options.orient) {
    case Orient::none:
      break;
    case Orient::up:
      return n[2];
    case Orient::viewpoint:
      return dot(n, options.viewpoint - in.position(i));
    case Orient::input:
      return dot(n, in.vector(0, i));
  }
  return 0;
}

}  // namespace

Normals::Normals(const NormalsOptions& options) : options_(options) {
  if (options.orient == Orient::viewpoint && !is_finite(options.viewpoint))
    fail_usage("normals: the viewpoint ({}, {}, {}) is not finite; give three numbers in the coordinates of the cloud",
               options.viewpoint.x, options.viewpoint.y, options.viewpoint.z);
}

Contract Normals::contract() const {
  Contract c;
  if (options_.orient == Orient::input) c.reads = {normal_attribute()};
  c.makes = {normal_attribute()};
  return c;
}

void Normals::apply(const Neighborhoods& in, Columns& out) const {
  const std::span<Normal> normals = out.column<Normal>(0);
  unoriented_normals(in, normals, out.degenerate());
  if (options_.orient == Orient::none) return;
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (along_wanted(options_, in, i, normals[i]) < 0) normals[i] = flipped(normals[i]);
  }
}

}  // namespace pointsweep
