// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "pointsweep/formats/las_scale.h"
#include "pointsweep/info.h"

namespace pointsweep {

std::optional<GpsTimes> gps_times(const FileSummary& summary) {
  const FileInfo& info = summary.info;
  const auto field = info.schema.find("gps_time");
  if (!field) return std::nullopt;
  const FieldRange& range = summary.ranges[*field];
  if (range.lo > range.hi || (range.lo == 0 && range.hi == 0)) return std::nullopt;
  if (!info.las || !info.las->has_time) return GpsTimes{range.lo, range.hi, GpsClock::unknown};
  return GpsTimes{range.lo, range.hi, info.las->standard_time ? GpsClock::adjusted_standard : GpsClock::week_seconds};
}

std::string gps_date(double adjusted_standard_seconds) {
  using namespace std::chrono;
  constexpr double kLatest = 220 * 365.25 * 86400;
  const double seconds_of_gps = std::floor(adjusted_standard_seconds + 1e9);
  if (!(seconds_of_gps >= 0 && seconds_of_gps < kLatest)) return {};
  const sys_seconds time = sys_days{1980y / January / 6} + seconds{static_cast<std::int64_t>(seconds_of_gps)};
  const auto day = floor<days>(time);
  const year_month_day date{day};
  const hh_mm_ss clock{time - day};
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), clock.hours().count(),
                     clock.minutes().count(), clock.seconds().count());
}

}  // namespace pointsweep
