// SPDX-License-Identifier: MIT
// Lesson 1: a pipeline on files. Normals of a scan of any size, in 256 MB of memory.
//
//   01_normals scan.ply out.ply
#include <cstdio>

#include "pointsweep/pointsweep.h"

int main(int argc, char** argv) try {
  if (argc != 3) return std::fprintf(stderr, "usage: %s IN OUT\n", argv[0]), 2;
  using namespace pointsweep;

  Cloud cloud({argv[1]});
  const Chain chain{.neighborhood = {.k = 8}, .stages = {operators::normals()}};
  RunOptions options;
  options.resources.memory_bytes = 256 << 20;
  options.overwrite = true;
  const Statistics statistics = run(cloud, chain, {.points = argv[2]}, options);

  std::printf("%llu points, %llu certified exact, at most %llu of them in memory at once\n",
              static_cast<unsigned long long>(statistics.points), static_cast<unsigned long long>(statistics.certified),
              static_cast<unsigned long long>(statistics.peak_points));
  return statistics.certified == statistics.points ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
