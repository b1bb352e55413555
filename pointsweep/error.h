// SPDX-License-Identifier: MIT
/// The one error type of the library: what is wrong, where, and what to do about it, in one sentence.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace pointsweep {

/// The user, a file or the machine is at fault. Thrown at set-up and by input and output only.
/// `what()` is one clear sentence for the user: file, place (`line 7`, `byte 312`, `stage 'normals'`), remedy.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The request itself makes no sense (an option out of range, a chain that does not fit): exit status 2 of the tool.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// The user asked a run to stop. Thrown where it is polled for; outputs and temporary files vanish as with any error.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

template <class... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(fmt::format(format, std::forward<Args>(args)...));
}

template <class... Args>
[[noreturn]] void fail_usage(fmt::format_string<Args...> format, Args&&... args) {
  throw UsageError(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace pointsweep
