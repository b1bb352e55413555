// SPDX-License-Identifier: MIT
/// What a request that makes no sense is told.
#pragma once

#include <string>

#include "pointsweep/error.h"

namespace pointsweep {

/// The sentence of the UsageError that `work` throws; empty if it throws none.
template <class Work>
std::string refusal(Work work) {
  try {
    work();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

}  // namespace pointsweep
