// SPDX-License-Identifier: MIT
#include "pointsweep/render/cloud_sample.h"

#include <algorithm>

#include "pointsweep/cancellation.h"
#include "pointsweep/math/mix.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kSample = 65536;
constexpr std::size_t kBlock = 8192;

/// The row of stretch `i` that is taken: any of its rows, so that no period of the file meets that of the sample.
std::uint64_t sampled_row(std::uint64_t i, std::uint64_t stretches, std::uint64_t rows) {
  const auto start = [&](std::uint64_t s) { return rows / stretches * s + rows % stretches * s / stretches; };
  return start(i) + mix(i) % (start(i + 1) - start(i));
}

}  // namespace

void for_each_block(InputCloud& cloud, const std::function<void(const PointBlock&)>& visit) {
  const std::size_t stride = cloud.schema().stride;
  const PositionFields fields = position_fields(cloud.schema(), "the input");
  std::vector<std::byte> records(kBlock * stride);
  std::vector<double> x(kBlock), y(kBlock), z(kBlock);
  for (std::uint64_t row = 0; row < cloud.count();) {
    stop_if_cancelled();
    const std::size_t n = cloud.read(row, records);
    decode_positions(fields, records.data(), stride, n, x.data(), y.data(), z.data());
    visit({row, n, records.data(), stride, x.data(), y.data(), z.data()});
    row += n;
  }
}

CloudSample sample_cloud(InputCloud& cloud, PointColor& color,
                         const std::function<void(std::uint64_t rows)>& progress) {
  CloudSample sample;
  const std::uint64_t stretches = std::min(kSample, cloud.count());
  std::uint64_t next = 0;  // stretch whose row is taken next
  for_each_block(cloud, [&](const PointBlock& block) {
    for (std::size_t i = 0; i < block.size; ++i) {
      const Vec3 p = block.position(i);
      color.look_at(block.record(i));
      const bool taken = next < stretches && sampled_row(next, stretches, cloud.count()) == block.first_row + i;
      if (taken) ++next;
      if (!is_finite(p)) continue;
      sample.bounds.include(p);
      ++sample.finite;
      if (!taken) continue;
      sample.positions.push_back(p);
      sample.records.insert(sample.records.end(), block.record(i), block.record(i) + block.stride);
    }
    progress(block.first_row + block.size);
  });
  return sample;
}

}  // namespace pointsweep
