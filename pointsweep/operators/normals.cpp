// SPDX-License-Identifier: MIT
#include "pointsweep/operators/normals.h"

#include <array>
#include <cmath>
#include <span>

#include "pointsweep/error.h"
#include "pointsweep/operators/normals_kernel.h"

namespace pointsweep {
namespace {

using Normal = std::array<float, 3>;

/// Adding 0 turns -0 into 0, so that no output shows which way a component was flipped.
Normal flipped(Normal n, bool flip) {
  const float sign = flip ? -1.0f : 1.0f;
  return {sign * n[0] + 0.0f, sign * n[1] + 0.0f, sign * n[2] + 0.0f};
}

/// The first of its largest components positive. Without branches, which would go either way.
Normal canonical(Normal n) {
  float largest = n[0];
  for (const std::size_t c : {1u, 2u}) largest = std::abs(n[c]) > std::abs(largest) ? n[c] : largest;
  return flipped(n, largest < 0);
}

double dot(Normal n, Vec3 v) { return pointsweep::dot({n[0], n[1], n[2]}, v); }

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
  unoriented_normals(in, normals);
  for (std::size_t i = 0; i < in.size(); ++i) {
    Normal& n = normals[i];
    if (n == Normal{}) {
      ++out.degenerate;
      continue;
    }
    n = canonical(n);
    double along = 0;  // negative: turn it round
    switch (options_.orient) {
      case Orient::none:
        break;
      case Orient::up:
        along = n[2];
        break;
      case Orient::viewpoint:
        along = dot(n, options_.viewpoint - in.position(i));
        break;
      case Orient::input: {
        const Normal given = in.value<Normal>(0, i);
        along = dot(n, {given[0], given[1], given[2]});
        break;
      }
    }
    n = flipped(n, along < 0);
  }
}

}  // namespace pointsweep
