// SPDX-License-Identifier: MIT
/// The meaning of the coordinates and times of a LAS file, kept where its points become another format.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/las_scale.h"

namespace pointsweep {

class Reader;

struct LasOrigin {
  LasQuantization grid;        ///< scale and offset of the integer coordinates
  bool has_time = false;       ///< the points have a GPS time
  bool standard_time = false;  ///< it is adjusted standard GPS time, not seconds of the GPS week
  /// Class 12 means the overlap of flight lines, as in LAS files of point formats 0 to 5.
  bool overlap_is_class_12 = false;
};

/// Returns the common origin of the inputs that are or were LAS: the finest scale of each axis with the offset of the
/// first input that has it, and the kind of time of the first input with a time. A warning names an input whose time is
/// of the other kind.
std::optional<LasOrigin> common_las_origin(const std::vector<std::unique_ptr<Reader>>& readers,
                                           std::vector<std::string>& warnings);

}  // namespace pointsweep
