// SPDX-License-Identifier: MIT
#include "pointsweep/fail.h"
#include "pointsweep/neighborhood.h"

namespace pointsweep {

SharedRule::~SharedRule() = default;

void refuse_value_size(std::size_t bytes, std::size_t asked) {
  fail_usage(
      "an operator asks for {} bytes of a value that has {}: give the type of the whole value, e.g. std::array<float, "
      "3> for a normal.",
      asked, bytes);
}

}  // namespace pointsweep
