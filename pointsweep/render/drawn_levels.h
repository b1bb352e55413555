// SPDX-License-Identifier: MIT
/// The levels of detail that a picture shows.
#pragma once

#include "pointsweep/formats/cloud/input_cloud.h"

namespace pointsweep {

/// During its lifetime, a cloud whose inputs all have levels of detail reads only as many of them as are needed until
/// the spacing of points is at most a pixel of a picture of this size; other clouds read all points.
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
