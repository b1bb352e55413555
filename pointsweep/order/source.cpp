// SPDX-License-Identifier: MIT
#include "pointsweep/order/source.h"

#include "pointsweep/fail.h"

namespace pointsweep {

void read_fully(const PointSource& source, std::uint64_t row, std::span<std::byte> records) {
  read_fully(source, source.read, row, records);
}

void read_fully(const PointSource& source, const ReadRows& read, std::uint64_t row, std::span<std::byte> records) {
  while (!records.empty()) {
    const std::size_t got = read(row, records);
    if (got == 0)
      fail(
          "the input ends at point {} though it holds {}: it was cut short while it was read; run again on the "
          "complete input.",
          row, source.count);
    row += got;
    records = records.subspan(got * source.schema.stride);
  }
}

}  // namespace pointsweep
