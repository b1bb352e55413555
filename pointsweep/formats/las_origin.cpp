// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las_origin.h"

#include <fmt/format.h>

#include "pointsweep/reader.h"

namespace pointsweep {
namespace {

void take_finer_grid(LasQuantization& grid, const LasQuantization& other) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(other.scale[axis] < grid.scale[axis])) continue;
    grid.scale[axis] = other.scale[axis];
    grid.offset[axis] = other.offset[axis];
  }
}

const char* name_of_time(const LasOrigin& origin) {
  return origin.standard_time ? "adjusted standard GPS time" : "seconds of the GPS week";
}

}  // namespace

std::optional<LasOrigin> common_las_origin(const std::vector<std::unique_ptr<Reader>>& readers,
                                           std::vector<std::string>& warnings) {
  std::optional<LasOrigin> common;
  const FileInfo* timed = nullptr;
  bool warned = false;
  for (const auto& reader : readers) {
    const FileInfo& info = reader->info();
    if (!info.las) continue;
    if (!common) common = LasOrigin{.grid = info.las->grid};
    take_finer_grid(common->grid, info.las->grid);
    if (!info.las->has_time) continue;
    if (timed == nullptr) {
      timed = &info;
      common->has_time = true;
      common->standard_time = info.las->standard_time;
    } else if (!warned && info.las->standard_time != common->standard_time) {
      warned = true;
      warnings.push_back(fmt::format("GPS times of {} are {}, those of {} {}; they are merged unchanged.",
                                     timed->path.string(), name_of_time(*timed->las), info.path.string(),
                                     name_of_time(*info.las)));
    }
  }
  return common;
}

}  // namespace pointsweep
