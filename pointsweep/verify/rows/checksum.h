// SPDX-License-Identifier: MIT
/// Checksums of values that do not depend on the order in which the values come.
#pragma once

#include <cstdint>

namespace pointsweep {

/// A bijection of 64-bit numbers that leaves no pattern (the output function of SplitMix64, Steele et al. 2014).
inline std::uint64_t scramble(std::uint64_t i) {
  i += 0x9e3779b97f4a7c15u;
  i = (i ^ i >> 30) * 0xbf58476d1ce4e5b9u;
  i = (i ^ i >> 27) * 0x94d049bb133111ebu;
  return i ^ i >> 31;
}

/// The sum of scrambled values modulo 2^64: equal for equal multisets, and for different ones with probability 2^-64.
class MultisetSum {
 public:
  void add(std::uint64_t value) { sum_ += scramble(value); }
  std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t sum_ = 0;
};

}  // namespace pointsweep
