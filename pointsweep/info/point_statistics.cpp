// SPDX-License-Identifier: MIT
#include <algorithm>
#include <limits>
#include <optional>

#include "pointsweep/fail.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/field_names.h"
#include "pointsweep/info.h"
#include "pointsweep/info/point_groups.h"
#include "pointsweep/info/value_keys.h"
#include "pointsweep/info/value_statistics.h"
#include "pointsweep/order/source.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kBytesOfGroups = 160 << 20;  ///< limit in bytes for moments, searches and counts of all groups
constexpr std::uint64_t kNumbersOfSearch = 8 << 20;  ///< limit for the counters of all searches, 8 bytes each
constexpr std::uint64_t kMostOfInterval = 1 << 20;   ///< limit for the counters of one interval of a search
constexpr std::uint64_t kLeastBins = 2, kMostBins = 1000;

/// An attribute with requested statistics, and the results for each group.
class Column {
 public:
  Column(const Field& field, bool values, bool histogram)
      : field_(field), keys_(field), values_(values), histogram_(histogram) {}

  std::uint64_t bytes_of_group(std::uint64_t bins) const {
    constexpr std::uint64_t kIntervals = 2 * RankSearch::kRanks * 64;
    return ValueMoments::bytes(keys_, values_) + (values_ ? sizeof(RankSearch) + kIntervals : 0) +
           (histogram_ ? 8 * bins : 0);
  }

  /// Takes records of a reading. `group_of`: group of each record; `groups`: number of groups so far; `is_first`: true
  /// in the first reading.
  void take(std::span<const std::byte> records, std::size_t stride, std::span<const std::uint32_t> group_of,
            std::size_t groups, bool is_first) {
    keys_.find(records, stride, found_);
    if (is_first) add_groups(groups);
    const std::size_t components = keys_.components();
    for (std::size_t at = 0; at < found_.size(); ++at) {
      const std::uint32_t group = group_of[components == 1 ? at : at / components];
      if (is_first)
        moments_[group].add(keys_, found_[at]);
      else if (keys_.is_finite(found_[at]))
        take_again(group, found_[at]);
    }
  }
  /// Prepares searches and bins. Must be called after the first reading.
  void settle(std::size_t groups, std::uint64_t bins) {
    add_groups(groups);
    for (const ValueMoments& moments : moments_)
      searches_.emplace_back(values_ ? moments.count() : 0, moments.least(), moments.most());
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max(), most = 0;
    for (const ValueMoments& moments : moments_)
      least = std::min(least, moments.least()), most = std::max(most, moments.most());
    if (!histogram_ || least > most) return;
    bins_.emplace(keys_, least, most, bins);
    counts_.assign(moments_.size() * bins_->size(), 0);
  }
  bool has_bins() const { return bins_.has_value(); }
  std::uint64_t open_intervals() const {
    std::uint64_t open = 0;
    for (const RankSearch& search : searches_) open += search.open();
    return open;
  }
  void begin_search(std::uint64_t share, bool counts) {
    std::uint64_t numbers = 0;
    for (RankSearch& search : searches_) search.begin(share, numbers);
    room_.assign(numbers, 0);
    is_counting_ = counts && bins_;
  }
  void end_search() {
    for (RankSearch& search : searches_) search.end(room_);
    room_ = {};
  }

  bool wants_values() const { return values_; }
  bool wants_histogram() const { return histogram_; }
  AttributeStatistics statistics(std::uint32_t group) const {
    AttributeStatistics result;
    const ValueMoments& moments = moments_[group];
    result.name = field_.name;
    result.type = field_.type;
    result.count = moments.count();
    result.nonfinite = moments.nonfinite();
    if (moments.count() == 0) return result;
    result.min = keys_.value(moments.least());
    result.max = keys_.value(moments.most());
    result.mean = moments.mean();
    result.deviation = moments.deviation();
    for (const std::uint64_t key : searches_[group].keys()) result.quantiles.push_back(keys_.value(key));
    return result;
  }
  AttributeHistogram histogram(std::uint32_t group) const {
    if (!bins_) return {field_.name, {}, {}};
    const auto counts = std::span(counts_).subspan(group * bins_->size(), bins_->size());
    return {field_.name, bins_->edges(), {counts.begin(), counts.end()}};
  }

 private:
  void add_groups(std::size_t groups) {
    while (moments_.size() < groups) moments_.emplace_back(keys_, values_);
  }
  void take_again(std::uint32_t group, std::uint64_t key) {
    searches_[group].add(key, room_);
    if (is_counting_) ++counts_[group * bins_->size() + bins_->bin_of(keys_, key)];
  }

  Field field_;
  ValueKeys keys_;
  bool values_, histogram_;
  bool is_counting_ = false;
  std::vector<std::uint64_t> found_;   ///< keys of the records of the last take()
  std::vector<ValueMoments> moments_;  ///< moments of each group
  std::vector<RankSearch> searches_;   ///< search of each group
  std::vector<std::uint64_t> room_;    ///< counters of the searches (RankSearch::add())
  std::optional<HistogramBins> bins_;
  std::vector<std::uint64_t> counts_;  ///< number of values in bin b of group g at g * bins_->size() + b
};

std::vector<Column> columns_of(const Schema& schema, const PointStatisticsOptions& options) {
  std::vector<bool> values(schema.fields.size(), options.values && options.keep.empty());
  std::vector<bool> histogram(schema.fields.size(), false);
  if (options.values)
    for (const std::size_t f : named_fields(schema, options.keep, "--keep")) values[f] = true;
  for (const std::size_t f : named_fields(schema, options.histograms, "--histogram")) histogram[f] = true;
  std::vector<Column> columns;
  for (std::size_t f = 0; f < schema.fields.size(); ++f)
    if (values[f] || histogram[f]) columns.emplace_back(schema.fields[f], values[f], histogram[f]);
  return columns;
}

/// Reads all points as often as the statistics need. The attributes of a block of points are distributed among the
/// threads.
class Readings {
 public:
  Readings(Cloud& cloud, const PointStatisticsOptions& options)
      : cloud_(cloud),
        options_(options),
        columns_(columns_of(cloud.schema(), options)),
        groups_(options.by.empty() ? PointGroups() : PointGroups(cloud.schema(), options.by)) {
    std::uint64_t bytes = 0;
    for (const Column& column : columns_) bytes += column.bytes_of_group(options.bins);
    most_groups_ = static_cast<std::size_t>(kBytesOfGroups / std::max<std::uint64_t>(bytes, 1));
  }

  PointStatistics run() {
    read(true);
    points_.resize(groups_.size());  // an empty cloud without grouping attribute has one group
    for (Column& column : columns_) column.settle(points_.size(), options_.bins);
    bool counts = std::ranges::any_of(columns_, &Column::has_bins);
    for (std::uint64_t open = open_intervals(); open > 0 || counts; open = open_intervals(), counts = false) {
      const std::uint64_t share =
          std::clamp<std::uint64_t>(kNumbersOfSearch / std::max<std::uint64_t>(open, 1), 2, kMostOfInterval);
      for (Column& column : columns_) column.begin_search(share, counts);
      read(false);
      for (Column& column : columns_) column.end_search();
    }
    cloud_.inputs().require_unchanged();
    return result();
  }

 private:
  std::uint64_t open_intervals() const {
    std::uint64_t open = 0;
    for (const Column& column : columns_) open += column.open_intervals();
    return open;
  }

  void read(bool is_first) {
    ++reading_;
    const std::size_t stride = cloud_.schema().stride;
    const std::uint64_t count = cloud_.count();
    ParallelRows rows(source_of(cloud_.inputs()));
    std::vector<std::byte> records;
    std::vector<std::uint32_t> group_of;
    for (std::uint64_t row = 0; row < count;) {
      const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(count - row, rows_at_once(stride)));
      records.resize(n * stride);
      rows.read(row, records);
      groups_.find(records, stride, is_first ? most_groups_ : 0, group_of);
      if (is_first) count_points(group_of);
      parallel_for(columns_.size(), [&](std::size_t c, unsigned) {
        columns_[c].take(records, stride, group_of, points_.size(), is_first);
      });
      row += n;
      if (options_.progress) options_.progress(reading_, row, count);
    }
  }

  void count_points(const std::vector<std::uint32_t>& group_of) {
    points_.resize(groups_.size(), 0);
    for (const std::uint32_t group : group_of) ++points_[group];
  }

  PointStatistics result() const {
    PointStatistics all{cloud_.count(), groups_.name(), {}};
    for (const std::uint32_t group : groups_.ascending()) {
      PointGroup& made = all.groups.emplace_back();
      if (!all.by.empty()) made.value = groups_.value(group);
      made.points = points_[group];
      for (const Column& column : columns_) {
        if (column.wants_values()) made.attributes.push_back(column.statistics(group));
        if (column.wants_histogram()) made.histograms.push_back(column.histogram(group));
      }
    }
    return all;
  }

  Cloud& cloud_;
  const PointStatisticsOptions& options_;
  std::vector<Column> columns_;
  PointGroups groups_;
  std::size_t most_groups_;
  std::vector<std::uint64_t> points_;  ///< number of points of each group
  unsigned reading_ = 0;
};

}  // namespace

PointStatistics point_statistics(Cloud& cloud, const PointStatisticsOptions& options) {
  if (options.bins < kLeastBins || options.bins > kMostBins)
    fail_usage("--bins: {} is not from {} to {}.", options.bins, kLeastBins, kMostBins);
  return Readings(cloud, options).run();
}

}  // namespace pointsweep
