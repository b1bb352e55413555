// SPDX-License-Identifier: MIT
/// The progress of a run, for people (standard error) and for programs (a descriptor of their choice).
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "cli/console/console.h"
#include "cli/verbs/common_options.h"

namespace pointsweep {

/// Display of the progress of a run. A terminal gets a bar with rate and remaining time, at most ten times a second,
/// without escape sequences; a terminal of less than 60 columns gets the percentage and the remaining time alone. Other
/// streams, and a terminal with TERM=dumb, get a line at most every five seconds. Programs get
/// `{"phase":"normals","done":123,"total":456,"seconds":0.5}` at most five times a second, and always the first and the
/// last report of a phase.
class ProgressDisplay {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  /// The descriptors for progress and sentences; -1 for none.
  struct Targets {
    int people = -1;
    int errors = -1;  ///< receives errors, which --quiet does not suppress
    bool terminal = false;
    int columns = 80;
    int programs = -1;
  };

  explicit ProgressDisplay(const CommonOptions& options);
  explicit ProgressDisplay(const Targets& targets, Clock clock = &std::chrono::steady_clock::now);
  ~ProgressDisplay();  ///< removes the bar from the terminal
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  /// Reports that `done` of `total` points have passed `phase`, e.g. "sort". Rate and time count from the first report
  /// of a phase. Thread-safe and cheap: a report that comes while another one is printed is dropped unless it completes
  /// the phase.
  void report(std::string_view phase, std::uint64_t done, std::uint64_t total);
  /// Prints a sentence above the bar. The sentence is not overwritten.
  void say(Severity severity, std::string_view sentence);

 private:
  using Time = std::chrono::steady_clock::time_point;
  bool due(Time now, Time& next, double interval, bool first, bool last);
  void print_for_people(std::uint64_t done, std::uint64_t total, double seconds);
  void print_for_programs(std::uint64_t done, std::uint64_t total, double seconds);
  void clear_bar();
  void write(int& descriptor, std::string_view text);

  std::mutex mutex_;
  Targets targets_;
  Clock clock_;
  std::string phase_;
  bool complete_ = false;
  std::size_t shown_ = 0;  ///< number of characters of the bar on the terminal
  Time start_, next_for_people_, next_for_programs_;
};

/// Returns a function that reports to `display`, which must outlive it. Throws Cancelled after an interruption.
std::function<void(const char* phase, std::uint64_t done, std::uint64_t total)> reporting_to(ProgressDisplay& display);

}  // namespace pointsweep
