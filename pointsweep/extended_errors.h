// SPDX-License-Identifier: MIT
/// Errors that get one more sentence on their way.
#pragma once

#include <string>

#include "pointsweep/cancellation.h"
#include "pointsweep/error.h"

namespace pointsweep {

/// Performs work(). Appends the text that added() returns to the sentence of an error. Leaves an error as it is if the
/// text is empty, and leaves UsageError and Cancelled as they are.
template <class Work, class Added>
void extending_errors(const Work& work, const Added& added) {
  try {
    work();
  } catch (const UsageError&) {
    throw;
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    const std::string text = added();
    if (text.empty()) throw;
    throw Error(error.what() + text);
  }
}

}  // namespace pointsweep
