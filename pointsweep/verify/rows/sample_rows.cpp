// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/sample_rows.h"

#include <algorithm>
#include <numeric>
#include <unordered_set>

#include "pointsweep/verify/rows/checksum.h"

namespace pointsweep {

std::vector<std::uint64_t> sample_rows(std::uint64_t count, std::uint64_t size, std::uint64_t seed) {
  std::vector<std::uint64_t> rows;
  if (size >= count) {
    rows.resize(count);
    std::iota(rows.begin(), rows.end(), std::uint64_t{0});
    return rows;
  }
  // Floyd's algorithm (Bentley and Floyd, "A sample of brilliance", 1987): one draw for each row that is chosen.
  std::unordered_set<std::uint64_t> chosen;
  for (std::uint64_t last = count - size; last < count; ++last) {
    const std::uint64_t draw = scramble(scramble(seed) ^ last) % (last + 1);
    if (!chosen.insert(draw).second) chosen.insert(last);
  }
  rows.assign(chosen.begin(), chosen.end());
  std::sort(rows.begin(), rows.end());
  return rows;
}

}  // namespace pointsweep
