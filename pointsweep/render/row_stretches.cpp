// SPDX-License-Identifier: MIT
#include "pointsweep/render/row_stretches.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace pointsweep {
namespace {

constexpr std::uint64_t kShortStretch = 256, kLongStretch = 8192, kTrials = 16;
constexpr double kDrawSeconds = 500e-9;  ///< time to draw a point, about
constexpr double kTrialShare = 0.1;      ///< of the time

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

RowStretches every_nth(const InputCloud& cloud, std::uint64_t n) {
  const bool seeks = cloud.decoder() != nullptr;  // else a jump may read all that lies between
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

/// Seconds to read a row, from stretches all over the cloud.
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

}  // namespace

RowStretches all_rows(const InputCloud& cloud) { return {{{0, cloud.count()}}, cloud.count()}; }

RowStretches rows_within(InputCloud& cloud, double seconds) {
  RowStretches rows = every_nth(cloud, 1);
  const double per_row = 2 * seconds_per_row(cloud, rows, kTrialShare * seconds) + kDrawSeconds;
  const double n = std::ceil(per_row * static_cast<double>(cloud.count()) / std::max(seconds, 1e-3));
  const auto most = static_cast<double>(std::max<std::size_t>(rows.stretches.size(), 1));
  return n <= 1 ? all_rows(cloud) : every_nth(cloud, static_cast<std::uint64_t>(std::min(n, most)));
}

}  // namespace pointsweep
