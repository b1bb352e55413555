// SPDX-License-Identifier: MIT
/// Throwing errors with formatted sentences.
#pragma once

#include <fmt/format.h>

#include <utility>

#include "pointsweep/error.h"

namespace pointsweep {

template <class... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(fmt::format(format, std::forward<Args>(args)...));
}

template <class... Args>
[[noreturn]] void fail_usage(fmt::format_string<Args...> format, Args&&... args) {
  throw UsageError(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace pointsweep
