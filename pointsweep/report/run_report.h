// SPDX-License-Identifier: MIT
/// The report of a run, as a page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pointsweep/pipeline/statistics.h"
#include "pointsweep/render/render.h"
#include "pointsweep/report/value_summary.h"

namespace pointsweep {

struct RunSummary {
  std::string title;           ///< e.g. "normals of scan.ply"
  std::string inputs, output;  ///< names of files
  std::string crs;             ///< the coordinate system, in words; empty: none is stated
  std::string unit;            ///< unit of the cloud's lengths; empty: not known
  std::string command;         ///< the command line, as a shell takes it
  std::string version;         ///< version of the program, e.g. "pointsweep 0.1.0"
  Statistics statistics;
  std::optional<Rendering> picture;  ///< of the result
  double drawing_seconds = 0;        ///< for reading the result again, and the picture
  std::vector<ValueSummary> made;    ///< of the result
};

/// Returns one self-contained HTML page. The result comes first: inputs and outputs, warnings, a picture, a histogram
/// of each made number with its percentiles, counts. The time by phase follows. The engine comes last: working set over
/// the stream, distances of neighbours (if they were counted), all other statistics.
std::string report_of(const RunSummary& summary);

}  // namespace pointsweep
