// SPDX-License-Identifier: MIT
/// Numbers that look random and are the same in every run.
#pragma once

#include <cstdint>

namespace pointsweep {

/// A bijection of 64-bit numbers that leaves no pattern (the output function of SplitMix64, Steele et al. 2014).
inline std::uint64_t mix(std::uint64_t i) {
  i = (i + 0x9e3779b97f4a7c15u);
  i = (i ^ i >> 30) * 0xbf58476d1ce4e5b9u;
  i = (i ^ i >> 27) * 0x94d049bb133111ebu;
  return i ^ i >> 31;
}

}  // namespace pointsweep
