// SPDX-License-Identifier: MIT
#include "pointsweep/order/survey.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pointsweep/error.h"
#include "pointsweep/order/mix.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kSample = 65536;
constexpr std::uint64_t kRuns = 1024;            ///< jumps a reader has to make
constexpr std::uint64_t kRun = kSample / kRuns;  ///< rows read at each
constexpr std::uint64_t kChunk = 16384;          ///< rows read at once by an exact survey

/// The first row of a sampled run: somewhere in the run's share of the rows, so that no period of the file (scan lines,
/// interleaved scanners) meets the period of the sample.
std::uint64_t run_begin(std::uint64_t run, std::uint64_t rows) {
  const auto share = [rows](std::uint64_t r) { return rows / kRuns * r + rows % kRuns * r / kRuns; };
  const std::uint64_t begin = share(run), end = share(run + 1);
  return begin + mix(run) % (end - begin - kRun + 1);
}

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
    for_each_chunk([&](std::uint64_t, std::size_t n) { sample(0, n); });
  }

  void sample_runs() {
    for (std::uint64_t run = 0; run < kRuns; ++run) {
      decode(run_begin(run, source_.count), kRun);
      sample(0, kRun);
    }
  }

  /// The same sample, and the bounds of all finite points.
  void sample_runs_and_bound_all() {
    std::uint64_t run = 0;
    for_each_chunk([&](std::uint64_t first, std::size_t n) {
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3 p{x_[i], y_[i], z_[i]};
        if (is_finite(p)) bounds_.include(p);
      }
      // A run may reach over the end of the chunk: what lies in this chunk is sampled now, the rest with the next.
      for (; run < kRuns; ++run) {
        const std::uint64_t begin = std::max(run_begin(run, source_.count), first);
        const std::uint64_t end = run_begin(run, source_.count) + kRun;
        if (begin < first + n) sample(begin - first, std::min<std::uint64_t>(end - first, n));
        if (end > first + n) break;
      }
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
    const std::uint32_t stride = source_.schema.stride;
    read_fully(source_, row, {records_.data(), n * stride});
    decode_positions(fields_, records_.data(), stride, n, x_.data(), y_.data(), z_.data());
  }

  void sample(std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 p{x_[i], y_[i], z_[i]};
      if (!is_finite(p)) continue;
      points.push_back(p);
      bounds_.include(p);
    }
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
