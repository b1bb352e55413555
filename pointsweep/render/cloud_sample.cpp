// SPDX-License-Identifier: MIT
#include "pointsweep/render/cloud_sample.h"

#include <algorithm>

#include "pointsweep/cancellation.h"
#include "pointsweep/math/mix.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kSample = 65536;
constexpr std::size_t kBlock = 8192;

/// Returns the row of stretch `i` that is sampled: any of its rows, so that no period of the file meets the period of
/// the sample.
std::uint64_t sampled_row(std::uint64_t i, std::uint64_t stretches, std::uint64_t rows) {
  const auto start = [&](std::uint64_t s) { return rows / stretches * s + rows % stretches * s / stretches; };
  return start(i) + mix(i) % (start(i + 1) - start(i));
}

}  // namespace

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
