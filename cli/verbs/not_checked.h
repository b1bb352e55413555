// SPDX-License-Identifier: MIT
/// Error that `verify` throws if it found nothing wrong but could not check everything. Its exit status is 3.
#pragma once

#include "pointsweep/error.h"

namespace pointsweep {

class NotChecked : public Error {
 public:
  using Error::Error;
};

}  // namespace pointsweep
