// SPDX-License-Identifier: MIT
/// Clouds for the oracles: generated clouds, and real clouds if the machine has them.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/support/data_folder.h"
#include "tests/support/sized.h"

namespace pointsweep {

/// Returns a closed surface with bumps and noise, whose neighbourhoods are not degenerate.
inline std::vector<Vec3> bumpy_surface(std::size_t count, std::uint64_t seed = 3) {
  std::mt19937_64 rng(seed);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    std::normal_distribution<double> g;
    Vec3 d{g(rng), g(rng), g(rng)};
    d = (1 / length(d)) * d;
    const double r = 1 + 0.1 * std::sin(5 * d.x) * std::cos(4 * d.y + 2 * d.z) + 0.002 * g(rng);
    p = {r * d.x, r * d.y, 1.5 * r * d.z};
  }
  return points;
}

struct RealCloud {
  std::string name;
  std::filesystem::path file;
};

inline std::vector<RealCloud> real_clouds() {
  const std::filesystem::path data = data_folder();
  std::vector<RealCloud> found;
  for (const auto& [name, file] : std::vector<std::pair<std::string, std::string>>{
           {"bunny", "models/stanford_bunny/reconstruction/bun_zipper_res3.ply"},
           {"dragon", "models/stanford_dragon/dragon_vrip_res3.ply"},
           {"airborne scan", "lidar/ign_las-digital-models/ground/test_data_77055_627760_LA93_IGN69.las"}})
    if (!data.empty() && std::filesystem::exists(data / file)) found.push_back({name, data / file});
  return found;
}

}  // namespace pointsweep
