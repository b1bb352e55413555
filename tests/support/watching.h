// SPDX-License-Identifier: MIT
/// An observer that calls functions.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "pointsweep/run.h"

namespace pointsweep {

struct Watching final : Observer {
  explicit Watching(std::function<void(const Progress&)> on_progress_,
                    std::function<void(const std::string&)> say_ = {})
      : report(std::move(on_progress_)), say(std::move(say_)) {}
  void on_progress(const Progress& progress) override {
    if (report) report(progress);
  }
  void on_warning(const std::string& sentence) override {
    if (say) say(sentence);
  }

  std::function<void(const Progress&)> report;
  std::function<void(const std::string&)> say;
};

}  // namespace pointsweep
