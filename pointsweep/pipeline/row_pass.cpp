// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/row_pass.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace pointsweep {
namespace {

constexpr std::size_t kRowChunkBytes = 1 << 20;

}  // namespace

RowPass::RowPass(const PlannedPass& pass) : pass_(pass), stages_(pass, pass.input) {}

void RowPass::run(const PointSource& source,
                  const std::function<void(std::uint64_t, std::size_t, const std::byte*)>& use) {
  const std::size_t stride = source.schema.stride;
  const std::size_t chunk = std::max<std::size_t>(1, kRowChunkBytes / stride);
  std::vector<std::byte> records, results;
  std::vector<std::uint64_t> rows;
  for (std::uint64_t row = 0; row < source.count;) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(chunk, source.count - row));
    records.resize(n * stride);
    read_fully(source, row, records);
    rows.resize(n);
    std::iota(rows.begin(), rows.end(), row);
    results.resize(n * pass_.plan.result_bytes);
    stages_.run(records.data(), rows, results.data());
    use(row, n, results.data());
    row += n;
  }
}

}  // namespace pointsweep
