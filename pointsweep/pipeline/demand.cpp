// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/demand.h"

#include <algorithm>
#include <thread>

namespace pointsweep {

MemoryDemand memory_demand(const Cloud& cloud, const Survey& survey, const RunOptions& options, bool whole,
                           std::size_t payload, std::uint64_t result_record_bytes) {
  const Schema& schema = cloud.schema();
  const PositionFields p =
      position_fields(schema, cloud.readers().empty() ? "The input" : cloud.readers().front()->info().path.string());
  const std::uint64_t carried =
      whole ? schema.stride : size_of(p.x.type) + size_of(p.y.type) + size_of(p.z.type) + 8 * payload;
  const std::uint64_t row_bytes = cloud.count() >> 32 ? 8 : 4;
  return {.points = cloud.count(),
          .working_record_bytes = carried + row_bytes,
          .result_record_bytes = result_record_bytes,
          .slab_points =
              options.slab_points != 0 ? options.slab_points : recommended_slab_points(cloud.count(), survey.dimension),
          .threads = options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency())};
}

}  // namespace pointsweep
