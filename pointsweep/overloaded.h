// SPDX-License-Identifier: MIT
/// A visitor of a variant, from one function for each alternative. An alternative without a function does not compile.
#pragma once

namespace pointsweep {

template <class... Functions>
struct overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
overloaded(Functions...) -> overloaded<Functions...>;

}  // namespace pointsweep
