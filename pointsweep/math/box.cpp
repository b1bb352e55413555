// SPDX-License-Identifier: MIT
#include "pointsweep/math/box.h"

#include <cstddef>
#include <vector>

#include "pointsweep/math/sort.h"
#include "pointsweep/threads.h"

namespace pointsweep {

Box middle_box(std::span<const Vec3> sample) {
  Box box;
  const std::size_t cut = sample.size() / 100;
  parallel_for(3, [&](std::size_t i, unsigned) {
    const int axis = static_cast<int>(i);
    std::vector<double> values(sample.size());
    std::ranges::transform(sample, values.begin(), [axis](const Vec3& p) { return p[axis]; });
    sort_ascending(std::span(values));
    box.lo[axis] = values[cut];
    box.hi[axis] = values[values.size() - 1 - cut];
  });
  return box;
}

}  // namespace pointsweep
