// SPDX-License-Identifier: MIT
#include "pointsweep/order/survey.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/math/sort.h"
#include "pointsweep/order/source.h"

namespace pointsweep {
namespace {

constexpr Encoding kSurveyEncoding{"survey", 1};

constexpr std::uint64_t kSample = 65536;
constexpr std::uint64_t kRuns = 1024;              ///< runs of sampled rows; a reader jumps to each of them
constexpr std::uint64_t kInRun = kSample / kRuns;  ///< rows sampled in each run
constexpr std::uint64_t kMostGap = 16;             ///< the survey reads at most this many times the rows of the sample

/// Least and greatest number of sample points from which the dimension is estimated.
constexpr std::size_t kTooFew = 256, kEnough = 16384;
/// Most cells along one axis, so that three cell numbers fit in 64 bits.
constexpr std::uint64_t kMostCells = 1u << 20;

/// The rows of the sample, ascending, in short runs spread over the whole file.
class SampledRows {
 public:
  /// Scanners write points line by line. Gaps this wide make the sample of a scan with as many lines as points on a
  /// line about as dense along the lines as across them. A sample without gaps would be short pieces of few lines.
  explicit SampledRows(std::uint64_t rows)
      : rows_(rows),
        gap_(std::min(static_cast<std::uint64_t>(std::sqrt(static_cast<double>(rows / kSample))), kMostGap)) {}

  /// Returns the first row of a run: somewhere in the run's share of the rows, so that no period of the file (scan
  /// lines, interleaved scanners) coincides with a period of the sample.
  std::uint64_t run_begin(std::uint64_t run) const {
    const std::uint64_t begin = share(run), end = share(run + 1);
    return begin + mix(run) % (end - begin - run_rows() + 1);
  }
  std::uint64_t run_rows() const { return kInRun * gap_; }

  /// Returns row `i` of the kSample rows of the sample.
  std::uint64_t operator[](std::uint64_t i) const {
    return run_begin(i / kInRun) + i % kInRun * gap_ + mix(kSample + i) % gap_;
  }

 private:
  std::uint64_t share(std::uint64_t run) const { return rows_ / kRuns * run + rows_ % kRuns * run / kRuns; }

  std::uint64_t rows_, gap_;
};

/// Reads ranges of rows of the source and keeps the sample and the bounds.
class Surveyor {
 public:
  explicit Surveyor(const PointSource& source)
      : source_(source), fields_(position_fields(source.schema, "the input")) {}

  void sample_runs() {
    const SampledRows rows(source_.count);
    for (std::uint64_t run = 0; run < kRuns; ++run) {
      const std::uint64_t begin = rows.run_begin(run);
      decode(begin, rows.run_rows());
      for (std::uint64_t i = run * kInRun; i < (run + 1) * kInRun; ++i) sample(rows[i] - begin);
    }
  }

  /// Reads all rows on all threads. Takes the sample (of at most kSample rows) and the bounds of all finite points.
  void look_at_all() {
    std::optional<SampledRows> rows;
    if (source_.count > kSample) rows.emplace(source_.count);
    const auto row_of = [&](std::uint64_t i) { return rows ? (*rows)[i] : i; };
    const std::uint64_t most = rows_at_once(source_.schema.stride), samples = std::min(kSample, source_.count);
    ParallelRows input(source_);
    std::uint64_t sampled = 0;
    for (std::uint64_t first = 0; first < source_.count; first += most) {
      resize(std::min(most, source_.count - first));
      input.read(first, records_);
      bounds_.include(decoded_box());
      for (; sampled < samples && row_of(sampled) < first + x_.size(); ++sampled) sample(row_of(sampled) - first);
    }
  }

  std::vector<Vec3> points;
  Box bounds() const { return bounds_; }

 private:
  void decode(std::uint64_t row, std::size_t n) {
    stop_if_cancelled();
    resize(n);
    read_fully(source_, row, records_);
    decode_positions(fields_, records_.data(), source_.schema.stride, n, x_.data(), y_.data(), z_.data());
  }

  void resize(std::size_t n) {
    records_.resize(n * source_.schema.stride);
    for (std::vector<double>* c : {&x_, &y_, &z_}) c->resize(n);
  }

  /// Decodes the positions of all records. Returns the box of the finite positions. Boxes are joined in the order of
  /// the records, so that the sign of a bound of zero does not depend on the number of threads.
  Box decoded_box() {
    const std::size_t stride = source_.schema.stride, all = x_.size();
    std::vector<Box> boxes((all + kTaskRows - 1) / kTaskRows);
    for_each_task(all, [&](std::size_t first, std::size_t n) {
      decode_positions(fields_, records_.data() + first * stride, stride, n, x_.data() + first, y_.data() + first,
                       z_.data() + first);
      for (std::size_t i = first; i < first + n; ++i) {
        const Vec3 p{x_[i], y_[i], z_[i]};
        if (is_finite(p)) boxes[first / kTaskRows].include(p);
      }
    });
    Box joined;
    for (const Box& box : boxes) joined.include(box);
    return joined;
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

bool contains(const Box& box, const Vec3& p) {
  return box.lo.x <= p.x && p.x <= box.hi.x && box.lo.y <= p.y && p.y <= box.hi.y && box.lo.z <= p.z && p.z <= box.hi.z;
}

/// Returns the number of cubes that contain a point, of a grid that divides the largest extent of `box` into `cells`.
std::size_t occupied_cells(std::span<const Vec3> points, const Box& box, std::uint64_t cells) {
  const Vec3 extent = box.extent();
  const double largest = std::max({extent.x, extent.y, extent.z});
  const auto last = static_cast<double>(cells - 1);
  std::vector<std::uint64_t> codes;
  codes.reserve(points.size());
  for (const Vec3& p : points) {
    std::uint64_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::min((p[axis] - box.lo[axis]) / largest * static_cast<double>(cells), last);
      code = code << 21 | static_cast<std::uint64_t>(cell);
    }
    codes.push_back(code);
  }
  sort_ascending(std::span(codes));
  return static_cast<std::size_t>(std::unique(codes.begin(), codes.end()) - codes.begin());
}

}  // namespace

Survey survey(const PointSource& source, std::optional<int> axis, bool exact) {
  Surveyor look(source);
  Survey result;
  result.exact = exact || source.count <= kSample;
  result.exact ? look.look_at_all() : look.sample_runs();
  result.bounds = look.bounds();
  result.sample = std::move(look.points);
  result.axis = axis ? *axis : result.bounds.longest_axis();
  result.dimension = box_counting_dimension(result.sample);
  return result;
}

void Survey::encode(Encoder& out) const {
  out.begin(kSurveyEncoding);
  out.put_list(sample, [&](Vec3 p) { out.put_point(p); });
  out.put_box(bounds);
  out.put_bool(exact);
  out.put<std::uint8_t>(static_cast<std::uint8_t>(axis));
  out.put<double>(dimension);
}

Survey Survey::decode(Decoder& in) {
  in.begin(kSurveyEncoding);
  return {.sample = in.get_list<Vec3>([&] { return in.get_point(); }),
          .bounds = in.get_box(),
          .exact = in.get_bool(),
          .axis = in.get<std::uint8_t>(),
          .dimension = in.get<double>()};
}

double box_counting_dimension(std::span<const Vec3> sample) {
  constexpr double kUndecided = 2;
  if (sample.size() < kTooFew) return kUndecided;
  const Box box = middle_box(sample);
  const Vec3 extent = box.extent();
  const double largest = std::max({extent.x, extent.y, extent.z});
  if (!(largest > 0) || !std::isfinite(largest)) return kUndecided;
  std::vector<Vec3> inside;
  for (std::size_t i = 0; i < sample.size(); i += sample.size() / kEnough + 1)
    if (contains(box, sample[i])) inside.push_back(sample[i]);
  if (inside.size() < kTooFew / 2) return kUndecided;

  // With fewer than about eight points per cell of the finer grid, some cells that the surface crosses would contain no
  // sample point. The numbers of cells along an axis are whole, since a cell that the end of the grid cuts off
  // would count as full.
  const std::size_t wanted = inside.size() / 8;
  std::uint64_t coarse_cells = 1;
  while (occupied_cells(inside, box, 2 * coarse_cells) < wanted && coarse_cells < kMostCells / 4) coarse_cells *= 2;
  for (std::uint64_t step = coarse_cells / 4; step >= 1 && step * 16 > coarse_cells; step /= 2)
    if (occupied_cells(inside, box, 2 * (coarse_cells - step)) >= wanted) coarse_cells -= step;
  const std::size_t fine = occupied_cells(inside, box, 2 * coarse_cells);
  if (fine < wanted) return kUndecided;
  const std::size_t coarse = occupied_cells(inside, box, coarse_cells);
  return std::clamp(std::log2(static_cast<double>(fine) / static_cast<double>(coarse)), 1.0, 3.0);
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
