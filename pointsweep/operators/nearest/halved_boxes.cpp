// SPDX-License-Identifier: MIT
#include "pointsweep/operators/nearest/halved_boxes.h"

#include <cstddef>

namespace pointsweep {

unsigned HalvedBoxes::levels_for(std::size_t points, std::size_t most) {
  unsigned levels = 0;
  while (((points - 1) >> levels) >= most) ++levels;
  return levels;
}

HalvedBoxes::HalvedBoxes(std::span<CellPoint> points, unsigned levels, bool in_plane)
    : points_(points.size()), levels_(levels), boxes_((std::size_t{2} << levels) - 1) {
  for (unsigned level = 0; level <= levels_; ++level) {
    for (std::size_t j = 0; j < std::size_t{1} << level; ++j) {
      const std::span<CellPoint> part = points.subspan(begin(level, j), begin(level, j + 1) - begin(level, j));
      Box& own = boxes_[(std::size_t{1} << level) - 1 + j];
      for (const CellPoint& p : part) own.include(in_plane ? Vec3{p.position.x, p.position.y, 0} : p.position);
      if (level == levels_) continue;
      const std::size_t middle = begin(level + 1, 2 * j + 1) - begin(level, j);
      std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(middle), part.end(),
                       [axis = own.longest_axis()](const CellPoint& a, const CellPoint& b) {
                         return a.position[axis] < b.position[axis];
                       });
    }
  }
}

}  // namespace pointsweep
