// SPDX-License-Identifier: MIT
/// One coordinate reference system for several inputs.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/reader.h"

namespace pointsweep {

struct CommonCrs {
  std::optional<Crs> crs;             ///< of the first input that states one; its WKT may be another's
  std::vector<std::string> warnings;  ///< inputs without a system; systems that could not be compared, or differ
};

/// Throws UsageError for inputs whose systems differ; with `ignore` that is a warning, and coordinates stay unchanged.
CommonCrs common_crs(const std::vector<std::unique_ptr<Reader>>& readers, bool ignore);

/// ", e.g. by 'pdal translate ...'": a command that transforms a file to the system; empty where it has no EPSG code.
std::string way_to_transform(const Crs& to);

}  // namespace pointsweep
