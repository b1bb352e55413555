// SPDX-License-Identifier: MIT
#include "pointsweep/search/exact_order.h"

#include <array>
#include <bit>
#include <cstddef>

namespace pointsweep {

void order_runs(const CellDirectory& directory, Vec3 p, std::uint64_t close_to_next, NeighborRef* refs) {
  std::array<Candidate, 64> run;
  while (close_to_next != 0) {
    const int begin = std::countr_zero(close_to_next);
    const int length = std::countr_one(close_to_next >> begin) + 1;
    const auto size = static_cast<std::size_t>(length);
    for (std::size_t i = 0; i < size; ++i)
      insert_sorted(candidate_from(directory, refs[begin + i], p), run.data(), i, run.size());
    for (std::size_t i = 0; i < size; ++i) refs[begin + i] = run[i].ref;
    close_to_next &= ~(((std::uint64_t{1} << (length - 1)) - 1) << begin);
  }
}

}  // namespace pointsweep
