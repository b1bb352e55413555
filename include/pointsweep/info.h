// SPDX-License-Identifier: MIT
/// Summaries of point files, made by reading all of their points; docs/info.md has the definitions. Programs that
/// include this header link pointsweep::info.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "pointsweep/cloud.h"
#include "pointsweep/export.h"
#include "pointsweep/geometry.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// The range of the values of one field of the records, all components together.
struct FieldRange {
  /// Least and greatest finite value; lo > hi if no value is finite.
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  std::uint64_t nonfinite = 0;  ///< number of NaN and infinite values
};

enum class GpsClock : std::uint8_t {
  week_seconds,       ///< seconds since the beginning of a GPS week that the file does not name
  adjusted_standard,  ///< seconds since 1980-01-06, less 10^9
  unknown
};

struct GpsTimes {
  double lo, hi;  ///< first and last time in seconds
  GpsClock clock;
};

struct FileSummary {
  /// The description by the reader, without extras. Its warnings include differences between the header and the points.
  FileInfo info;
  Box bounds;                   ///< bounds of the finite points
  std::uint64_t nonfinite = 0;  ///< number of points with a NaN or infinite coordinate
  /// For x, y and z: `ascending` is true if the coordinates of finite points never decrease from row to row,
  /// `descending` if they never increase.
  std::array<bool, 3> ascending{true, true, true};
  std::array<bool, 3> descending{true, true, true};
  std::vector<FieldRange> ranges;            ///< range of each field of the schema
  std::array<std::uint64_t, 256> classes{};  ///< number of points of each class, if `has_classes`
  std::array<std::uint64_t, 16> returns{};   ///< number of points of each return number, if `has_returns`
  std::uint64_t returns_beyond = 0;          ///< number of points whose return number exceeds their number of returns
  double area = 0, cell_side = 0;            ///< area of the occupied cells in x and y, and the side of a cell
  std::vector<double> nearest;               ///< distances to the nearest neighbours of a sample, ascending
  /// `has_classes` is true if the file has the field `classification`, `has_returns` if it has return numbers.
  bool has_classes = false, has_returns = false;
  /// True if only the header was read: `bounds` are the stated bounds, and other facts about the points are unknown.
  bool of_header = false;

  /// Returns the number of finite points per unit of occupied area; nothing without an area.
  std::optional<double> density() const;
  /// Returns the median of `nearest`.
  std::optional<double> spacing() const;
  /// Returns the number of points in the sample with the same coordinates as another point.
  std::size_t duplicates() const;
};

struct SummaryOptions {
  bool spacing = true;  ///< true to measure FileSummary::nearest, which takes a second reading of the points
  /// Called after each piece of work; may throw to end it.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress = {};
};

/// Reads all points of a file in sequence. Memory: about 10 MB. Throws Error if the file cannot be read to its end.
POINTSWEEP_EXPORT FileSummary summarize(Reader& reader, const SummaryOptions& options = {});

/// Returns the facts in the header, without reading points. Facts that a format without a header does not state are
/// those found when the file was opened.
POINTSWEEP_EXPORT FileSummary summarize_header(const Reader& reader);

/// Returns the range of the field `gps_time`, with the clock of the LAS header; nothing without this field, or if it
/// has no finite value but 0.
POINTSWEEP_EXPORT std::optional<GpsTimes> gps_times(const FileSummary& summary);

/// Returns the date and time of adjusted standard GPS time, such as "2010-06-15T12:34:56", on the GPS scale (ahead of
/// UTC by leap seconds, 18 since 2017); empty if it is not between the years 1980 and 2200.
POINTSWEEP_EXPORT std::string gps_date(double adjusted_standard_seconds);

/// Returns a line like "pointsweep 0.1.0: knn(k=12) | normals; order sweep; from scan.ply", in printable ASCII, for
/// each run that made the file, oldest first.
POINTSWEEP_EXPORT std::vector<std::string> made_by(const FileInfo& info);

/// Returns the number and the name of a class of LAS 1.4 (ASPRS): "2 Ground", "12 Reserved", "64 User definable".
POINTSWEEP_EXPORT std::string text_of_class(std::uint8_t code);

/// Returns a sentence for each respect in which files of one data set differ: formats, coordinate reference
/// systems, clocks of GPS times, attributes that some files lack, and their types; then files without points, with
/// coordinates that are not finite, and with the same bounds and number of points. Empty for fewer than two files.
POINTSWEEP_EXPORT std::vector<std::string> inconsistencies_of(std::span<const FileSummary> files);

/// Finds inconsistencies_of() files that are summarized one after another. Keeps the number of points, the bounds and
/// the name of each file, about 150 bytes, and one copy of each distinct set of header facts.
class POINTSWEEP_EXPORT FileComparison {
 public:
  FileComparison();
  ~FileComparison();
  FileComparison(FileComparison&&) noexcept;
  FileComparison& operator=(FileComparison&&) noexcept;
  void add(const FileSummary& file);
  /// Returns the sentences of inconsistencies_of() about the files so far.
  std::vector<std::string> sentences() const;

 private:
  struct Known;
  std::unique_ptr<Known> known_;
};

/// A value of an attribute: a whole number if the attribute has whole numbers, unsigned if it is a uint64.
using AttributeValue = std::variant<double, std::int64_t, std::uint64_t>;

/// The values of one attribute, all components together. Integers with a decimal scale are taken as decimal fractions.
/// Without a finite value, min, max and mean are absent and there are no quantiles.
struct AttributeStatistics {
  std::string name;
  Type type = Type::f64;        ///< type in the records of the cloud
  std::uint64_t count = 0;      ///< number of finite values
  std::uint64_t nonfinite = 0;  ///< number of NaN and infinite values
  std::optional<AttributeValue> min, max;
  std::optional<double> mean;  ///< the rounded exact sum divided by `count`; absent if it is beyond float64
  /// Standard deviation, by `count` - 1; absent for fewer than two values, and if the sum of squares is beyond float64.
  std::optional<double> deviation;
  std::vector<AttributeValue> quantiles;  ///< a quantile for each of PointStatistics::kPercent
};

/// Counts of the finite values of one attribute: counts[i] is the number of values in [edges[i], edges[i + 1]). Edges
/// are multiples of the bin width, which is 1, 2 or 5 times a power of ten, and at least 1 for whole numbers.
struct AttributeHistogram {
  std::string name;
  std::vector<double> edges;          ///< edges of bins, ascending, one more than counts; empty without finite values
  std::vector<std::uint64_t> counts;  ///< counts of the bins; if all points are one group, the first and last are not 0
};

/// The points that have one value of an attribute, or all points.
struct PointGroup {
  /// Value of the attribute PointStatistics::by, a whole number; absent if all points are one group.
  std::optional<AttributeValue> value;
  std::uint64_t points = 0;
  std::vector<AttributeStatistics> attributes;
  std::vector<AttributeHistogram> histograms;  ///< histograms, whose edges are equal in all groups
};

struct PointStatistics {
  /// The quantile of p percent of n ascending values v[0] ... v[n - 1] is v[floor(p / 100 (n - 1))].
  static constexpr std::array<unsigned, 7> kPercent{1, 5, 25, 50, 75, 95, 99};
  static constexpr std::size_t kMostGroups = 10'000;

  std::uint64_t points = 0;
  std::string by;                  ///< name of the attribute that groups points; empty if they are one group
  std::vector<PointGroup> groups;  ///< groups, ascending by value
};

struct PointStatisticsOptions {
  std::string by;       ///< name of the attribute whose values, all whole numbers, group points; empty for one group
  bool values = false;  ///< true to make PointGroup::attributes
  std::vector<std::string> keep;        ///< names of the attributes to evaluate; empty for all, coordinates included
  std::vector<std::string> histograms;  ///< names of the attributes that get a histogram
  std::uint64_t bins = 20;              ///< largest number of bins of a histogram, 2 to 1,000
  /// Called after each piece of work of a reading of all points. Readings count from 1. May throw to end the work.
  std::function<void(unsigned reading, std::uint64_t done, std::uint64_t total)> progress = {};
};

/// Reads all points of a cloud once, and again for histograms and for quantiles: two or three times for clouds of up to
/// a million points, about three to five times for others, more for many groups. Every number is exact or rounded as
/// stated, and the same for any number of threads and order of the points. Memory: at most 256 MB, and less than 100 MB
/// without `by`. Throws UsageError for a missing attribute, for `bins` out of range, and for `by` if the attribute has
/// a value that is no whole number, more than kMostGroups values, or too many values for this memory; Error for a file
/// that cannot be read.
POINTSWEEP_EXPORT PointStatistics point_statistics(Cloud& cloud, const PointStatisticsOptions& options);

/// Returns the JSON value that the key `statistics` has in the output of `pointsweep info`; docs/info.md lists its
/// keys.
POINTSWEEP_EXPORT std::string to_json(const PointStatistics& statistics);

/// Returns the JSON object of one file; docs/info.md lists its keys.
POINTSWEEP_EXPORT std::string to_json(const FileSummary& summary);

}  // namespace pointsweep
