// SPDX-License-Identifier: MIT
/// Summaries of point files, made by reading all of their points; docs/info.md has the definitions. Programs that
/// include this header link pointsweep::info.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/export.h"
#include "pointsweep/geometry.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// The range of the values of one field of the records, all components together.
struct FieldRange {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;  ///< of the finite ones; lo > hi: there is none
  std::uint64_t nonfinite = 0;                                    ///< NaN and infinite values
};

enum class GpsClock : std::uint8_t {
  week_seconds,       ///< seconds since the beginning of a GPS week that the file does not name
  adjusted_standard,  ///< seconds since 1980-01-06, less 10^9
  unknown
};

struct GpsTimes {
  double lo, hi;  ///< seconds
  GpsClock clock;
};

struct FileSummary {
  /// The description by the reader, without extras. The warnings also say where the header does not fit the points.
  FileInfo info;
  Box bounds;                                       ///< of the finite points
  std::uint64_t nonfinite = 0;                      ///< points with a NaN or infinite coordinate
  std::array<bool, 3> ascending{true, true, true};  ///< no finite point lies below the one before it along x, y, z
  std::array<bool, 3> descending{true, true, true};
  std::vector<FieldRange> ranges;            ///< of the fields of the schema
  std::array<std::uint64_t, 256> classes{};  ///< points of each class, if there is a field `classification`
  std::array<std::uint64_t, 16> returns{};   ///< points of each return number, if there is such a field
  std::uint64_t returns_beyond = 0;          ///< points whose return number is above their number of returns
  double area = 0, cell_side = 0;            ///< of the occupied cells in x and y, and the side of a cell
  std::vector<double> nearest;               ///< distances to the nearest neighbours of a sample, ascending
  bool has_classes = false, has_returns = false;
  bool of_header = false;  ///< of the header alone: bounds are those that it states, and nothing of the points is known

  /// Finite points for each unit of occupied area; none without area.
  std::optional<double> density() const;
  /// The median of `nearest`.
  std::optional<double> spacing() const;
  /// Points of the sample that have the coordinates of another point.
  std::size_t duplicates() const;
};

struct SummaryOptions {
  bool spacing = true;  ///< measure `nearest`, which takes a second reading
  /// Called after each piece of work; may throw to end it.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress = {};
};

/// Reads all points of a file in sequence. Memory: about 10 MB. Throws Error where the file cannot be read to its end.
POINTSWEEP_EXPORT FileSummary summarize(Reader& reader, const SummaryOptions& options = {});

/// Returns what the header says, without a look at the points. Formats without a header were read when they were opened.
POINTSWEEP_EXPORT FileSummary summarize_header(const Reader& reader);

/// Returns the range of the field `gps_time`, with the clock of the LAS header; none without the field or if all are 0.
POINTSWEEP_EXPORT std::optional<GpsTimes> gps_times(const FileSummary& summary);

/// "2010-06-15T12:34:56": date and time of adjusted standard GPS time, on the GPS scale (ahead of UTC by leap seconds,
/// 18 since 2017). Empty if it is not between the years 1980 and 2200.
POINTSWEEP_EXPORT std::string gps_date(double adjusted_standard_seconds);

/// Returns a sentence for each respect in which files of one data set differ: formats, coordinate reference
/// systems, clocks of GPS times, attributes that some files lack, and their types; then files without points, with
/// coordinates that are not finite, and with the same bounds and number of points. Empty for fewer than two files.
POINTSWEEP_EXPORT std::vector<std::string> inconsistencies_of(std::span<const FileSummary> files);

/// Returns the JSON object of one file; docs/info.md lists its keys.
POINTSWEEP_EXPORT std::string to_json(const FileSummary& summary);

}  // namespace pointsweep
