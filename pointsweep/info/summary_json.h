// SPDX-License-Identifier: MIT
/// The parts of the JSON object that `info --json` writes.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "pointsweep/geometry.h"
#include "pointsweep/info.h"

namespace pointsweep {

/// Returns the object of one file; docs/info.md lists its keys.
nlohmann::ordered_json json_of(const FileSummary& summary);
nlohmann::ordered_json json_of(const Box& bounds);
nlohmann::ordered_json json_of(const PointStatistics& statistics);

}  // namespace pointsweep
