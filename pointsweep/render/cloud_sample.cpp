// SPDX-License-Identifier: MIT
#include "pointsweep/render/cloud_sample.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "pointsweep/cancellation.h"
#include "pointsweep/math/mix.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kShortStretch = 256, kLongStretch = 8192, kTrials = 16;
constexpr double kDrawSeconds = 500e-9;  ///< approximate time to draw a point
constexpr double kTrialShare = 0.1;      ///< share of the time limit that measuring may take

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

RowStretches every_nth(const InputCloud& cloud, std::uint64_t n) {
  const bool seeks = cloud.decoder() != nullptr;  // a reader without a decoder may have to read the rows that it skips
  RowStretches rows;
  std::uint64_t i = 0;
  for (std::uint64_t row = 0; row < cloud.count(); ++i) {
    const std::uint64_t chunk = seeks ? cloud.chunk_end(row) : row;
    const std::uint64_t end =
        chunk > row ? chunk : std::min(row + (seeks ? kShortStretch : kLongStretch), cloud.count());
    if (i % n == 0) {
      rows.stretches.push_back({row, end});
      rows.count += end - row;
    }
    row = end;
  }
  return rows;
}

/// Measures the seconds to read a row, in stretches from all parts of the cloud; begins no further one after `seconds`.
double seconds_per_row(InputCloud& cloud, const RowStretches& rows, double seconds) {
  std::vector<std::byte> records(kLongStretch * cloud.schema().stride);
  const auto start = Clock::now();
  const std::size_t step = std::max<std::size_t>(1, rows.stretches.size() / kTrials);
  std::uint64_t read = 0;
  for (std::size_t s = 0; s < rows.stretches.size() && (s == 0 || seconds_since(start) < seconds); s += step)
    for (std::uint64_t row = rows.stretches[s].begin; row < rows.stretches[s].end;) {
      const std::uint64_t n = std::min(kLongStretch, rows.stretches[s].end - row);
      row += cloud.read(row, std::span(records).first(n * cloud.schema().stride));
      read += n;
    }
  return seconds_since(start) / static_cast<double>(std::max<std::uint64_t>(read, 1));
}

constexpr std::uint64_t kSample = 65536;
constexpr std::size_t kBlock = 8192;

/// Returns the row of stretch `i` that is sampled. The row is pseudorandom, so that a period of rows in the file does
/// not coincide with the period of the sample.
std::uint64_t sampled_row(std::uint64_t i, std::uint64_t stretches, std::uint64_t rows) {
  const auto start = [&](std::uint64_t s) { return rows / stretches * s + rows % stretches * s / stretches; };
  return start(i) + mix(i) % (start(i + 1) - start(i));
}

}  // namespace

RowStretches all_rows(const InputCloud& cloud) { return {{{0, cloud.count()}}, cloud.count()}; }

RowStretches rows_within(InputCloud& cloud, double seconds) {
  RowStretches rows = every_nth(cloud, 1);
  const double per_row = 2 * seconds_per_row(cloud, rows, kTrialShare * seconds) + kDrawSeconds;
  const double n = std::ceil(per_row * static_cast<double>(cloud.count()) / std::max(seconds, 1e-3));
  const auto most = static_cast<double>(std::max<std::size_t>(rows.stretches.size(), 1));
  return n <= 1 ? all_rows(cloud) : every_nth(cloud, static_cast<std::uint64_t>(std::min(n, most)));
}

PossibleViews::PossibleViews(std::optional<Angles> angles, std::optional<Up> up) {
  std::vector<Up> ups;
  for (const int axis : {0, 1, 2})
    for (const int sign : {1, -1}) ups.push_back({axis, sign});
  if (up) ups = {*up};
  for (const Up& u : ups) {
    for (const Angles& a : angles ? std::vector{*angles} : std::vector{kTop, kThreeQuarter})
      views_.push_back({{a, u}, camera_of({a, u}, {}, 0, 0), {}});
  }
}

void PossibleViews::include(Vec3 p) {
  if (!origin_) origin_ = p;
  const Vec3 d = p - *origin_;
  for (Possible& v : views_) {
    const double x = dot(d, v.camera.right), y = dot(d, v.camera.up);
    v.extents.lo_x = std::min(v.extents.lo_x, x), v.extents.hi_x = std::max(v.extents.hi_x, x);
    v.extents.lo_y = std::min(v.extents.lo_y, y), v.extents.hi_y = std::max(v.extents.hi_y, y);
  }
}

Extents PossibleViews::extents(const View& view, const Camera& camera) const {
  const auto found = std::ranges::find(views_, view, &Possible::view);
  Extents extents = found->extents;
  const Vec3 moved = *origin_ - camera.origin;
  const double x = dot(moved, camera.right), y = dot(moved, camera.up);
  extents.lo_x += x, extents.hi_x += x, extents.lo_y += y, extents.hi_y += y;
  return extents;
}

void for_each_block(InputCloud& cloud, const RowStretches& rows, const std::function<void(const PointBlock&)>& visit) {
  const std::size_t stride = cloud.schema().stride;
  const PositionFields fields = position_fields(cloud.schema(), "the input");
  std::vector<std::byte> records(kBlock * stride);
  std::vector<double> x(kBlock), y(kBlock), z(kBlock);
  std::uint64_t done = 0;
  for (const RowStretch& stretch : rows.stretches) {
    for (std::uint64_t row = stretch.begin; row < stretch.end;) {
      stop_if_cancelled();
      const std::size_t wanted = std::min<std::uint64_t>(kBlock, stretch.end - row);
      const std::size_t n = cloud.read(row, std::span(records).first(wanted * stride));
      decode_positions(fields, records.data(), stride, n, x.data(), y.data(), z.data());
      visit({done, n, records.data(), stride, x.data(), y.data(), z.data()});
      row += n, done += n;
    }
  }
}

CloudSample sample_cloud(InputCloud& cloud, const RowStretches& rows, PointColor& color, PossibleViews& views,
                         const std::function<void(std::uint64_t done)>& progress) {
  CloudSample sample;
  const std::uint64_t stretches = std::min(kSample, rows.count);
  std::uint64_t next = 0;  // stretch whose row is taken next
  for_each_block(cloud, rows, [&](const PointBlock& block) {
    for (std::size_t i = 0; i < block.size; ++i) {
      const Vec3 p = block.position(i);
      color.look_at(block.record(i));
      const bool taken = next < stretches && sampled_row(next, stretches, rows.count) == block.first + i;
      if (taken) ++next;
      if (!is_finite(p)) continue;
      sample.bounds.include(p);
      views.include(p);
      ++sample.finite;
      if (!taken) continue;
      sample.positions.push_back(p);
      sample.records.insert(sample.records.end(), block.record(i), block.record(i) + block.stride);
    }
    progress(block.first + block.size);
  });
  return sample;
}

}  // namespace pointsweep
