// SPDX-License-Identifier: MIT
/// The times of a scan, as LAS states them and files made of LAS keep it.
#pragma once

#include <optional>
#include <string>

#include "cli/file_summary.h"

namespace pointsweep {

enum class GpsClock {
  week_seconds,       ///< seconds since the beginning of a GPS week that the file does not name
  adjusted_standard,  ///< seconds since 1980-01-06, less 10^9
  unknown
};

struct GpsTimes {
  double lo, hi;  ///< seconds
  GpsClock clock;
};

/// The range of the field `gps_time`, none if there is none or it is 0 throughout. The clock is that of the LAS header.
std::optional<GpsTimes> gps_times(const FileInfo& info, const FileSummary& summary);

/// "2010-06-15T12:34:56": date and time of adjusted standard GPS time, on the GPS scale (ahead of UTC by leap seconds,
/// 18 since 2017). Empty if it is not between the years 1980 and 2200.
std::string gps_date(double adjusted_standard_seconds);

}  // namespace pointsweep
