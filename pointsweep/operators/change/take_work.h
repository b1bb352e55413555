// SPDX-License-Identifier: MIT
/// The run of `take` over the points of a cloud.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/operators/change/take.h"

namespace pointsweep {

/// The options and the bound attributes of a Take.
struct TakeRules {
  TakeOptions options;
  std::string place;  ///< beginning of messages
  std::vector<TakenAttribute> taken;
  std::vector<TakeTarget> targets;
};

/// Reads the other cloud and returns the work. Throws Error if the other cloud has no point with a finite place.
/// `rules` are the rules of a bound operator.
std::unique_ptr<InOrderWork> start_taking(TakeRules rules, const InOrderSetup& setup);

/// Returns the least memory of the work. `value_bytes`: bytes of the values taken from a point.
std::uint64_t least_taking_bytes(std::uint64_t k, std::uint64_t value_bytes);

}  // namespace pointsweep
