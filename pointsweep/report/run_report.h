// SPDX-License-Identifier: MIT
/// What a run did, as a page.
#pragma once

#include <optional>
#include <string>

#include "pointsweep/pipeline/statistics.h"
#include "pointsweep/render/render.h"

namespace pointsweep {

struct RunSummary {
  std::string title;           ///< e.g. "normals of scan.ply"
  std::string inputs, output;  ///< names of files
  Statistics statistics;
  std::optional<Rendering> picture;  ///< of the result
};

/// One self-contained HTML page: picture, working set over the stream, time per operator, distances of neighbours (if
/// they were counted), all statistics, warnings.
std::string report_of(const RunSummary& summary);

}  // namespace pointsweep
