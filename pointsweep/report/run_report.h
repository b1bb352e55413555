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
  std::string command;         ///< the command line, as a shell takes it
  std::string version;         ///< of the program, e.g. "pointsweep 0.1.0"
  Statistics statistics;
  std::optional<Rendering> picture;  ///< of the result
};

/// One self-contained HTML page: picture, working set over the stream, time per operator, distances of neighbours (if
/// they were counted), the command line, the version, all statistics, warnings.
std::string report_of(const RunSummary& summary);

}  // namespace pointsweep
