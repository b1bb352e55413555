// SPDX-License-Identifier: MIT
#include "pointsweep/order/survey.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/math/mix.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kSample = 65536;
constexpr std::uint64_t kRuns = 1024;              ///< jumps a reader has to make
constexpr std::uint64_t kInRun = kSample / kRuns;  ///< rows sampled at each
constexpr std::uint64_t kMostGap = 16;             ///< so many times the rows of the sample are read at most
constexpr std::uint64_t kChunk = 16384;            ///< rows read at once by an exact survey

/// Which rows are sampled: ascending, some in each of the runs that lie all over the file.
class SampledRows {
 public:
  /// A scanner writes line after line. With gaps as wide as this, the sample of a square of lines is about as dense
  /// along the lines as across them, where successive rows would be short pieces of few lines.
  explicit SampledRows(std::uint64_t rows)
      : rows_(rows),
        gap_(std::min(static_cast<std::uint64_t>(std::sqrt(static_cast<double>(rows / kSample))), kMostGap)) {}

  /// The first row of a run: somewhere in the run's share of the rows, so that no period of the file (scan lines,
  /// interleaved scanners) meets the period of the sample.
  std::uint64_t run_begin(std::uint64_t run) const {
    const std::uint64_t begin = share(run), end = share(run + 1);
    return begin + mix(run) % (end - begin - run_rows() + 1);
  }
  std::uint64_t run_rows() const { return kInRun * gap_; }

  /// Row `i` of kSample.
  std::uint64_t operator[](std::uint64_t i) const {
    return run_begin(i / kInRun) + i % kInRun * gap_ + mix(kSample + i) % gap_;
  }

 private:
  std::uint64_t share(std::uint64_t run) const { return rows_ / kRuns * run + rows_ % kRuns * run / kRuns; }

  std::uint64_t rows_, gap_;
};

/// Reads pieces of the source and keeps what a survey needs of them.
class Surveyor {
 public:
  explicit Surveyor(const PointSource& source)
      : source_(source),
        fields_(position_fields(source.schema, "the input")),
        records_(kChunk * source.schema.stride),
        x_(kChunk),
        y_(kChunk),
        z_(kChunk) {}

  void sample_everything() {
    for_each_chunk([&](std::uint64_t, std::size_t n) {
      for (std::size_t i = 0; i < n; ++i) sample(i);
    });
  }

  void sample_runs() {
    const SampledRows rows(source_.count);
    for (std::uint64_t run = 0; run < kRuns; ++run) {
      const std::uint64_t begin = rows.run_begin(run);
      decode(begin, rows.run_rows());
      for (std::uint64_t i = run * kInRun; i < (run + 1) * kInRun; ++i) sample(rows[i] - begin);
    }
  }

  /// The same sample, and the bounds of all finite points.
  void sample_runs_and_bound_all() {
    const SampledRows rows(source_.count);
    std::uint64_t sampled = 0;
    for_each_chunk([&](std::uint64_t first, std::size_t n) {
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3 p{x_[i], y_[i], z_[i]};
        if (is_finite(p)) bounds_.include(p);
      }
      for (; sampled < kSample && rows[sampled] < first + n; ++sampled) sample(rows[sampled] - first);
    });
  }

  std::vector<Vec3> points;
  Box bounds() const { return bounds_; }

 private:
  template <class Visit>
  void for_each_chunk(Visit&& visit) {
    for (std::uint64_t first = 0; first < source_.count; first += kChunk) {
      const std::size_t n = std::min(kChunk, source_.count - first);
      decode(first, n);
      visit(first, n);
    }
  }

  void decode(std::uint64_t row, std::size_t n) {
    stop_if_cancelled();
    const std::uint32_t stride = source_.schema.stride;
    read_fully(source_, row, {records_.data(), n * stride});
    decode_positions(fields_, records_.data(), stride, n, x_.data(), y_.data(), z_.data());
  }

  void sample(std::size_t i) {
    const Vec3 p{x_[i], y_[i], z_[i]};
    if (!is_finite(p)) return;
    points.push_back(p);
    bounds_.include(p);
  }

  const PointSource& source_;
  PositionFields fields_;
  std::vector<std::byte> records_;
  std::vector<double> x_, y_, z_;
  Box bounds_;
};

}  // namespace

Survey survey(const PointSource& source, std::optional<int> axis, bool exact) {
  Surveyor look(source);
  if (source.count <= kSample)
    look.sample_everything();
  else if (exact)
    look.sample_runs_and_bound_all();
  else
    look.sample_runs();
  Survey result;
  result.bounds = look.bounds();
  result.sample = std::move(look.points);
  result.exact = exact || source.count <= kSample;
  result.axis = axis ? *axis : result.bounds.longest_axis();
  result.dimension = box_counting_dimension(result.sample);
  return result;
}

std::uint64_t recommended_slab_points(std::uint64_t points, double dimension) {
  const double d = std::clamp(dimension, 2.0, 3.0);
  const double slab = (16 - 10 * (d - 2)) * std::pow(static_cast<double>(points), (d - 1) / d);
  return std::max<std::uint64_t>(16384, static_cast<std::uint64_t>(slab));
}

void require_distances(const Box& bounds) {
  if (bounds.empty()) return;
  const double extent = bounds.extent()[bounds.longest_axis()];
  if (extent == 0 || (extent >= 0x1p-480 && extent <= 0x1p+510)) return;
  fail("The cloud is {:.2g} long, and double precision cannot hold squares of such distances: scale its coordinates.",
       extent);
}

}  // namespace pointsweep
