// SPDX-License-Identifier: MIT
/// Decodes all records of a point file with the library's readers, like a run. Prints the number of points, the time
/// including opening the file, and the bounds, which are not part of the time, as JSON.
///   read_points IN THREADS
#include <algorithm>
#include <cstdio>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "bench/formats/measured.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/order/source.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/threads.h"

namespace bench {
namespace {

constexpr std::size_t kBlock = std::size_t{16} << 20;

using namespace pointsweep;

/// Calls look(schema, records, n) for the n records of each block, in order. Returns the number of points.
template <class Look>
std::uint64_t read_all(const std::string& path, Look look) {
  InputCloud cloud({path});
  ParallelRows rows(source_of(cloud));
  const std::size_t stride = cloud.schema().stride;
  std::vector<std::byte> records(std::max<std::size_t>(1, kBlock / stride) * stride);
  for (std::uint64_t row = 0; row < cloud.count();) {
    const std::size_t n = std::min<std::uint64_t>(records.size() / stride, cloud.count() - row);
    rows.read(row, std::span(records).first(n * stride));
    look(cloud.schema(), records, n);
    row += n;
  }
  return cloud.count();
}

Box bounds_of(const std::string& path) {
  Box box;
  read_all(path, [&](const Schema& schema, const std::vector<std::byte>& records, std::size_t n) {
    std::vector<double> axes[3];
    for (auto& axis : axes) axis.resize(n);
    decode_positions(position_fields(schema, path), records.data(), schema.stride, n, axes[0].data(), axes[1].data(),
                     axes[2].data());
    for (std::size_t i = 0; i < n; ++i) box.include(Vec3{axes[0][i], axes[1][i], axes[2][i]});
  });
  return box;
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) try {
  if (argc != 3) return std::fprintf(stderr, "usage: %s IN THREADS\n", argv[0]), 2;
  pointsweep::with_threads(std::stoi(argv[2]), [&] {
    std::uint64_t points = 0;
    const bench::Seconds took =
        bench::measured([&] { points = bench::read_all(argv[1], [](const auto&, const auto&, std::size_t) {}); });
    const pointsweep::Box box = bench::bounds_of(argv[1]);
    std::printf("{\"points\": %llu, \"wall_seconds\": %.6f, \"cpu_seconds\": %.6f, ",
                static_cast<unsigned long long>(points), took.wall, took.cpu);
    std::printf("\"bounds\": [%.17g, %.17g, %.17g, %.17g, %.17g, %.17g]}\n", box.lo.x, box.lo.y, box.lo.z, box.hi.x,
                box.hi.y, box.hi.z);
  });
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
