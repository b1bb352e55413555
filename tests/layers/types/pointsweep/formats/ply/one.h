// SPDX-License-Identifier: MIT
/// Wrong on purpose: two types of one name. The check of type names must refuse them.
#pragma once

namespace pointsweep {

struct Twice {
  int a;
};

}  // namespace pointsweep
