// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/row_pass.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/order/parallel_rows.h"
#include "pointsweep/prefetch.h"

namespace pointsweep {

RowPass::RowPass(const PlannedPass& pass) : pass_(pass), stages_(pass, pass.input) {}

void RowPass::run(const PointSource& source,
                  const std::function<void(std::uint64_t, std::size_t, const std::byte*)>& use) {
  const std::size_t stride = source.schema.stride, most = rows_at_once(stride);
  ParallelRows input(source);
  std::array<std::vector<std::byte>, 2> buffers;  // one of records in use, one of those read ahead
  const auto read = [&](std::size_t turn) {
    const std::uint64_t row = turn * most;
    std::vector<std::byte>& records = buffers[turn % 2];
    records.resize(std::min<std::uint64_t>(most, source.count - row) * stride);
    input.read(row, records);
    return std::span<const std::byte>(records);
  };
  const std::size_t turns = (source.count + most - 1) / most;
  std::optional<Prefetch<std::span<const std::byte>>> ahead;  // another thread may read the source beside this one
  if (input.is_parallel()) ahead.emplace(read, 0, turns, 1);
  std::vector<std::byte> results;
  std::vector<std::uint64_t> rows;
  for (std::size_t turn = 0; turn < turns; ++turn) {
    const std::span<const std::byte> records = ahead ? ahead->next() : read(turn);
    rows.resize(records.size() / stride);
    std::iota(rows.begin(), rows.end(), turn * most);
    results.resize(rows.size() * pass_.plan.result_bytes);
    stages_.run(records.data(), rows, results.data());
    use(turn * most, rows.size(), results.data());
  }
}

}  // namespace pointsweep
