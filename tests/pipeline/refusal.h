// SPDX-License-Identifier: MIT
/// The sentence with which a wrong request is refused.
#pragma once

#include <string>

#include "pointsweep/error.h"

namespace pointsweep {

/// Returns the sentence of the UsageError that `work` throws; empty if it throws none.
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
