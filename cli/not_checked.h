// SPDX-License-Identifier: MIT
/// What `verify` throws where it found nothing wrong and could not check everything: status 3.
#pragma once

#include "pointsweep/error.h"

namespace pointsweep {

class NotChecked : public Error {
 public:
  using Error::Error;
};

}  // namespace pointsweep
