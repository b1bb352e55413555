// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/cloud_source.h"

#include <memory>

namespace pointsweep {

PointSource source_of(InputCloud& cloud, const std::function<void(std::size_t rows)>& note) {
  const auto noted = [note](std::size_t rows) {
    note(rows);
    return rows;
  };
  return {.schema = cloud.schema(),
          .count = cloud.count(),
          .read = [&cloud, noted](std::uint64_t row,
                                  std::span<std::byte> records) { return noted(cloud.read(row, records)); },
          .for_thread = [&cloud, noted](const std::vector<std::size_t>& wanted) -> ReadRows {
            const std::shared_ptr<RowDecoder> own = cloud.decoder(wanted);
            if (!own) return {};
            return [own, noted](std::uint64_t row, std::span<std::byte> records) {
              return noted(own->read(row, records));
            };
          },
          .chunk_end = [&cloud](std::uint64_t row) { return cloud.chunk_end(row); }};
}

}  // namespace pointsweep
