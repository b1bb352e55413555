// SPDX-License-Identifier: MIT
/// Errors of the command line with formatted sentences.
#pragma once

#include <fmt/format.h>

#include <utility>

#include "pointsweep/error.h"

namespace pointsweep {

/// Throws UsageError with the formatted sentence.
template <class... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> sentence, Args&&... args) {
  throw UsageError(fmt::format(sentence, std::forward<Args>(args)...));
}

}  // namespace pointsweep
