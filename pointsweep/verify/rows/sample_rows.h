// SPDX-License-Identifier: MIT
/// The random sample of the rows that a check evaluates.
#pragma once

#include <cstdint>
#include <vector>

namespace pointsweep {

/// `size` different rows of 0 ... count - 1, ascending, every set of them equally likely; all rows if there are no
/// more. The same seed gives the same rows.
std::vector<std::uint64_t> sample_rows(std::uint64_t count, std::uint64_t size, std::uint64_t seed);

}  // namespace pointsweep
