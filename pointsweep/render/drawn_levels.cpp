// SPDX-License-Identifier: MIT
#include "pointsweep/render/drawn_levels.h"

#include <algorithm>

#include "pointsweep/formats/chosen_chunks.h"

namespace pointsweep {

InputCloud drawn_levels(const InputCloud& cloud, unsigned pixels) {
  Box bounds;
  double coarsest = 0;
  for (const auto& reader : cloud.readers()) {
    const FileInfo& info = reader->info();
    if (!info.root_spacing || !info.bounds) return cloud;
    bounds.include(*info.bounds);
    coarsest = std::max(coarsest, *info.root_spacing);
  }
  const Vec3 extent = bounds.extent();
  const double pixel = std::max({extent.x, extent.y, extent.z}) / pixels;
  const int depth = depth_of_spacing(coarsest, pixel);
  return cloud.with_chunks([&](const Chunk& chunk) { return chunk.depth <= depth; });
}

}  // namespace pointsweep
