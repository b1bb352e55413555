// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/observation.h"

#include <cmath>

#include "pointsweep/formats/registry.h"

namespace pointsweep {

std::vector<DistanceBin> bins_of(const NeighborDistances& distances) {
  const auto bin = [&](std::size_t i) {
    return DistanceBin{std::sqrt(DistanceHistogram::lower_end2(i)), std::sqrt(DistanceHistogram::lower_end2(i + 1)),
                       distances.nearest.count(i), distances.farthest.count(i)};
  };
  const auto empty = [&](std::size_t i) { return distances.nearest.count(i) + distances.farthest.count(i) == 0; };
  std::vector<DistanceBin> bins;
  if (!empty(0)) bins.push_back(bin(0));
  std::size_t first = 1, end = DistanceHistogram::kBins - 1;
  while (first < end && empty(first)) ++first;
  while (first < end && empty(end - 1)) --end;
  for (std::size_t i = first; i < end; ++i) bins.push_back(bin(i));
  return bins;
}

void write_states(const std::vector<PointState>& states, const std::filesystem::path& path, bool overwrite) {
  OutputPlan plan{.path = path, .schema = {}, .count = states.size(), .extras = {}, .overwrite = overwrite};
  plan.schema.append("state", Type::u8);
  const std::unique_ptr<Writer> writer = array_format().create(plan);
  writer->write(std::as_bytes(std::span(states)));
  writer->finish();
}

}  // namespace pointsweep
