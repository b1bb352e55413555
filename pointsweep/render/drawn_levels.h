// SPDX-License-Identifier: MIT
/// The levels of detail that a picture shows.
#pragma once

#include "pointsweep/formats/cloud/input_cloud.h"

namespace pointsweep {

/// While it lives, a cloud whose inputs all have levels of detail reads as many of them as it takes until points lie no
/// farther apart than a pixel of a picture that is so many pixels wide or high; any other cloud reads all points.
class DrawnLevels {
 public:
  DrawnLevels(InputCloud& cloud, unsigned pixels);
  ~DrawnLevels() { cloud_.read_all_chunks(); }
  DrawnLevels(const DrawnLevels&) = delete;
  DrawnLevels& operator=(const DrawnLevels&) = delete;

 private:
  InputCloud& cloud_;
};

}  // namespace pointsweep
