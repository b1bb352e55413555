// SPDX-License-Identifier: MIT
/// Wrong on purpose: another file defines a type Twice, too. The check of type names must refuse both.
#pragma once

namespace pointsweep {

struct Twice {
  double b;
};

}  // namespace pointsweep
