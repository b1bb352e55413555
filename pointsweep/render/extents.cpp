// SPDX-License-Identifier: MIT
#include "pointsweep/render/extents.h"

#include <algorithm>

namespace pointsweep {

PossibleViews::PossibleViews(std::optional<Angles> angles, std::optional<Up> up) {
  std::vector<Up> ups;
  for (const int axis : {0, 1, 2})
    for (const int sign : {1, -1}) ups.push_back({axis, sign});
  if (up) ups = {*up};
  for (const Up& u : ups) {
    for (const Angles& a : angles ? std::vector{*angles} : std::vector{kTop, kThreeQuarter})
      views_.push_back({{a, u}, camera_of({a, u}, {}, 0, 0), {}});
  }
}

void PossibleViews::include(Vec3 p) {
  if (!origin_) origin_ = p;
  const Vec3 d = p - *origin_;
  for (Possible& v : views_) {
    const double x = dot(d, v.camera.right), y = dot(d, v.camera.up);
    v.extents.lo_x = std::min(v.extents.lo_x, x), v.extents.hi_x = std::max(v.extents.hi_x, x);
    v.extents.lo_y = std::min(v.extents.lo_y, y), v.extents.hi_y = std::max(v.extents.hi_y, y);
  }
}

Extents PossibleViews::extents(const View& view, const Camera& camera) const {
  const auto found = std::ranges::find(views_, view, &Possible::view);
  Extents extents = found->extents;
  const Vec3 moved = *origin_ - camera.origin;
  const double x = dot(moved, camera.right), y = dot(moved, camera.up);
  extents.lo_x += x, extents.hi_x += x, extents.lo_y += y, extents.hi_y += y;
  return extents;
}

}  // namespace pointsweep
