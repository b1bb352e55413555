// SPDX-License-Identifier: MIT
/// The extras that a format keeps of an input, as the type of that format.
#pragma once

#include <memory>

#include "pointsweep/reader.h"

namespace pointsweep {

/// Returns null for extras of another format than Extras::kFormat, and where there are none.
template <class Extras>
const Extras* extras_as(const std::shared_ptr<const FormatExtras>& extras) {
  return extras && extras->format() == Extras::kFormat ? static_cast<const Extras*>(extras.get()) : nullptr;
}

}  // namespace pointsweep
