// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/formats/las_classes.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/info.h"
#include "pointsweep/info/point_spacing.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/points/decimals.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {
namespace {

/// Returns the largest difference that rounding explains between a bound in the header and the same bound of the
/// points: half a step of the grid, and 2^-50 of `bound` for the rounding of decimal numbers.
double tolerance_of(const Field& coordinate, double bound) {
  return 0.5 * coordinate.scale + 4 * std::abs(bound) * 0x1p-52;
}

void add_wrong_bounds(const FileInfo& info, const Box& points, std::vector<std::string>& faults) {
  if (points.empty()) return;
  const Box& stated = info.claims->bounds;
  const PositionFields fields = position_fields(info.schema, info.path.string());
  const Field* const coordinates[] = {&fields.x, &fields.y, &fields.z};
  for (int axis = 0; axis < 3; ++axis) {
    const auto agree = [&](double a, double b) { return std::abs(a - b) <= tolerance_of(*coordinates[axis], b); };
    if (agree(stated.lo[axis], points.lo[axis]) && agree(stated.hi[axis], points.hi[axis])) continue;
    faults.push_back(fmt::format("the header states {} from {:.15g} to {:.15g}; the points have {:.15g} to {:.15g}.",
                                 "xyz"[axis], stated.lo[axis], stated.hi[axis], points.lo[axis], points.hi[axis]));
  }
}

void add_wrong_counts(const FileSummary& summary, std::vector<std::string>& faults) {
  if (!summary.has_returns) return;
  const std::vector<std::uint64_t>& stated = summary.info.claims->returns;
  std::string header, points;
  for (std::size_t r = 1; r <= stated.size() && r < summary.returns.size(); ++r) {
    if (stated[r - 1] == summary.returns[r]) continue;
    const char* const comma = header.empty() ? "" : ", ";
    header += fmt::format("{}{}: {}", comma, r, stated[r - 1]);
    points += fmt::format("{}{}: {}", comma, r, summary.returns[r]);
  }
  if (!header.empty())
    faults.push_back(fmt::format("the header counts points by return as {}; there are {}.", header, points));
}

/// Returns a sentence for each axis on which the header's bounds are wrong by more than rounding explains, one for all
/// wrong counts of points by return, and one for points whose return number exceeds their number of returns.
std::vector<std::string> header_faults(const FileSummary& summary) {
  const FileInfo& info = summary.info;
  std::vector<std::string> faults;
  if (info.claims) {
    add_wrong_bounds(info, summary.bounds, faults);
    add_wrong_counts(summary, faults);
  }
  if (summary.returns_beyond > 0)
    faults.push_back(fmt::format("{} {} a return number above the number of returns.", summary.returns_beyond,
                                 summary.returns_beyond == 1 ? "point has" : "points have"));
  return faults;
}

constexpr std::size_t kPiece = 1 << 16;  // points
constexpr std::uint64_t kSample = 1000;  // largest number of points whose nearest neighbours are found

/// Consecutive points of the file: their records and positions.
struct Piece {
  std::uint64_t first_row = 0;
  std::size_t count = 0;
  const std::byte* records = nullptr;
  const double *x = nullptr, *y = nullptr, *z = nullptr;
  Vec3 position(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

void for_each_piece(Reader& reader, const std::function<void(const Piece&)>& visit) {
  const FileInfo& info = reader.info();
  const PositionFields position = position_fields(info.schema, info.path.string());
  const std::size_t most = std::min<std::uint64_t>(kPiece, info.count);
  std::vector<std::byte> records(most * info.schema.stride);
  std::vector<double> x(most), y(most), z(most);
  for (std::uint64_t row = 0; row < info.count;) {
    const std::size_t count = reader.read(row, records);
    if (count == 0)
      fail("{}: ends at point {} of {}; it has changed while it was read.", info.path.string(), row, info.count);
    decode_positions(position, records.data(), info.schema.stride, count, x.data(), y.data(), z.data());
    visit({row, count, records.data(), x.data(), y.data(), z.data()});
    row += count;
  }
}

/// One pseudo-random row from each of kSample stretches of rows, whose lengths differ by at most 1, so that no period
/// of the file coincides with a period of the sample. A file of fewer rows has all of them in the sample.
class SampledRows {
 public:
  explicit SampledRows(std::uint64_t rows) : rows_(rows), stretches_(std::min(kSample, rows)) { advance(); }
  /// Must be called for each row in order.
  bool contains(std::uint64_t row) {
    if (row != next_row_) return false;
    advance();
    return true;
  }

 private:
  std::uint64_t start(std::uint64_t s) const { return rows_ / stretches_ * s + rows_ % stretches_ * s / stretches_; }
  void advance() {
    if (next_ == stretches_) {
      next_row_ = rows_;
      return;
    }
    next_row_ = start(next_) + mix(next_) % (start(next_ + 1) - start(next_));
    ++next_;
  }
  std::uint64_t rows_, stretches_, next_ = 0, next_row_ = 0;
};

void add_position(FileSummary& summary, Vec3 previous, Vec3 p) {
  for (int axis = 0; axis < 3; ++axis) {
    summary.ascending[static_cast<std::size_t>(axis)] &= p[axis] >= previous[axis];
    summary.descending[static_cast<std::size_t>(axis)] &= p[axis] <= previous[axis];
  }
  summary.bounds.include(p);
}

void add_value(FieldRange& range, double value) {
  if (!std::isfinite(value)) {
    ++range.nonfinite;
    return;
  }
  range.lo = std::min(range.lo, value);
  range.hi = std::max(range.hi, value);
}

void add_ranges(FileSummary& summary, const Schema& schema, const Piece& piece) {
  for (std::size_t f = 0; f < schema.fields.size(); ++f) {
    const Field& field = schema.fields[f];
    for (std::size_t i = 0; i < piece.count; ++i)
      for (std::uint32_t c = 0; c < field.count; ++c)
        add_value(summary.ranges[f], value_of(field, piece.records + i * schema.stride, c));
  }
}

/// Counts the points of each value of `field`, rounded down, from 0 to N - 1; other values are ignored.
template <std::size_t N>
void add_counts(std::array<std::uint64_t, N>& counts, const Field& field, const Schema& schema, const Piece& piece) {
  for (std::size_t i = 0; i < piece.count; ++i) {
    const double value = value_of(field, piece.records + i * schema.stride);
    if (value >= 0 && value < static_cast<double>(N)) ++counts[static_cast<std::size_t>(value)];
  }
}

/// Returns the number of points whose value of `number` exceeds their value of `most`.
std::uint64_t points_above(const Field& number, const Field& most, const Schema& schema, const Piece& piece) {
  std::uint64_t points = 0;
  for (std::size_t i = 0; i < piece.count; ++i) {
    const std::byte* const record = piece.records + i * schema.stride;
    points += value_of(number, record) > value_of(most, record);
  }
  return points;
}

/// Replaces the bounds and ranges of fields that store integers on a decimal grid by decimal fractions (GridDecimals).
void use_decimals(FileSummary& summary, const Schema& schema) {
  for (std::size_t f = 0; f < schema.fields.size(); ++f) {
    const GridDecimals decimals(schema.fields[f]);
    summary.ranges[f].lo = decimals.of(summary.ranges[f].lo);
    summary.ranges[f].hi = decimals.of(summary.ranges[f].hi);
  }
  if (summary.bounds.empty()) return;
  for (int axis = 0; axis < 3; ++axis) {
    const GridDecimals decimals(schema.fields[schema.find(std::string(1, "xyz"[axis])).value()]);
    summary.bounds.lo[axis] = decimals.of(summary.bounds.lo[axis]);
    summary.bounds.hi[axis] = decimals.of(summary.bounds.hi[axis]);
  }
}

std::vector<double> nearest_distances(Reader& reader, std::vector<NearestDistances::Sampled> sample,
                                      const std::function<void(std::uint64_t)>& progress) {
  NearestDistances nearest(std::move(sample));
  for_each_piece(reader, [&](const Piece& piece) {
    for (std::size_t i = 0; i < piece.count; ++i)
      if (is_finite(piece.position(i))) nearest.add(piece.position(i), piece.first_row + i);
    progress(piece.first_row + piece.count);
  });
  return nearest.distances();
}

}  // namespace

std::optional<double> FileSummary::density() const {
  if (!(area > 0)) return std::nullopt;
  return static_cast<double>(info.count - nonfinite) / area;
}

std::optional<double> FileSummary::spacing() const {
  if (nearest.empty()) return std::nullopt;
  return nearest[(nearest.size() - 1) / 2];
}

std::size_t FileSummary::duplicates() const {
  return static_cast<std::size_t>(std::ranges::upper_bound(nearest, 0.0) - nearest.begin());
}

FileSummary summarize(Reader& reader, const SummaryOptions& options) {
  const FileInfo& info = reader.info();
  const auto classes = info.schema.find("classification"), returns = info.schema.find("return_number");
  const auto of_returns = info.schema.find("number_of_returns");
  const std::uint64_t work = options.spacing ? 2 * info.count : info.count;
  const auto progress = [&](std::uint64_t done) {
    if (options.progress) options.progress(done, work);
  };
  FileSummary summary;
  summary.info = info;
  summary.info.extras = nullptr;
  summary.ranges.resize(info.schema.fields.size());
  summary.has_classes = classes.has_value();
  summary.has_returns = returns.has_value();
  PlanArea plan(info.count);
  SampledRows rows(info.count);
  std::vector<NearestDistances::Sampled> sample;
  std::optional<Vec3> previous;
  for_each_piece(reader, [&](const Piece& piece) {
    for (std::size_t i = 0; i < piece.count; ++i) {
      const Vec3 p = piece.position(i);
      const bool sampled = rows.contains(piece.first_row + i);
      if (!is_finite(p)) {
        ++summary.nonfinite;
        continue;
      }
      add_position(summary, previous.value_or(p), p);
      plan.add(p.x, p.y);
      if (sampled) sample.push_back({p, piece.first_row + i});
      previous = p;
    }
    add_ranges(summary, info.schema, piece);
    if (classes) add_counts(summary.classes, info.schema.fields[*classes], info.schema, piece);
    if (returns) add_counts(summary.returns, info.schema.fields[*returns], info.schema, piece);
    if (returns && of_returns)
      summary.returns_beyond +=
          points_above(info.schema.fields[*returns], info.schema.fields[*of_returns], info.schema, piece);
    progress(piece.first_row + piece.count);
  });
  plan.settle();
  use_decimals(summary, info.schema);
  summary.area = plan.area();
  summary.cell_side = plan.cell_side();
  if (options.spacing)
    summary.nearest =
        nearest_distances(reader, std::move(sample), [&](std::uint64_t done) { progress(info.count + done); });
  std::ranges::copy(header_faults(summary), std::back_inserter(summary.info.warnings));
  return summary;
}

FileSummary summarize_header(const Reader& reader) {
  const FileInfo& info = reader.info();
  FileSummary summary;
  summary.info = info;
  summary.info.extras = nullptr;
  summary.ranges.resize(info.schema.fields.size());
  summary.of_header = true;
  if (!info.bounds || !is_finite(info.bounds->lo) || !is_finite(info.bounds->hi)) return summary;
  const Vec3 extent = info.bounds->extent();
  if (info.count > 0 && std::min({extent.x, extent.y, extent.z}) >= 0) summary.bounds = *info.bounds;
  return summary;
}

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

std::vector<std::string> made_by(const FileInfo& info) {
  std::vector<std::string> lines;
  for (const ProvenanceRecord& record : records_of(info.provenance)) lines.push_back(to_text(record));
  return lines;
}

std::string text_of_class(std::uint8_t code) { return fmt::format("{} {}", code, name_of_las_class(code)); }

}  // namespace pointsweep
