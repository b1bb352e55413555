// SPDX-License-Identifier: MIT
/// Addition of a sentence to errors that pass through.
#pragma once

#include <string>

#include "pointsweep/cancellation.h"
#include "pointsweep/error.h"

namespace pointsweep {

/// Performs work(). Appends the text that added() returns to the sentence of an Error. Errors are unchanged if the text
/// is empty; UsageError and Cancelled are always unchanged.
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
