// SPDX-License-Identifier: MIT
#include "cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <nlohmann/json.hpp>

#include "cli/quantities.h"

namespace pointsweep {
namespace {

constexpr double kBarInterval = 0.1;      // s
constexpr double kLineInterval = 5;       // s
constexpr double kProgramInterval = 0.2;  // s
constexpr int kBarWidth = 24;             // characters

ProgressDisplay::Targets targets_of(const CommonOptions& options) {
  ProgressDisplay::Targets targets;
  targets.programs = options.progress_descriptor;
  if (options.quiet) return targets;
  targets.people = STDERR_FILENO;
  targets.terminal = isatty(STDERR_FILENO) != 0;
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) targets.columns = size.ws_col;
  return targets;
}

/// "8.40M of 20.0M points, 12.1M/s, 0:02 left"
std::string figures(std::uint64_t done, std::uint64_t total, double seconds) {
  std::string text =
      fmt::format("{} of {} points", count_text(static_cast<double>(done)), count_text(static_cast<double>(total)));
  if (done == 0 || seconds <= 0) return text;
  const double rate = static_cast<double>(done) / seconds;
  text += fmt::format(", {}/s", count_text(rate));
  if (done < total) text += fmt::format(", {} left", duration_text(static_cast<double>(total - done) / rate));
  return text;
}

}  // namespace

ProgressDisplay::ProgressDisplay(const CommonOptions& options) : ProgressDisplay(targets_of(options)) {}

ProgressDisplay::ProgressDisplay(const Targets& targets, Clock clock) : targets_(targets), clock_(std::move(clock)) {}

ProgressDisplay::~ProgressDisplay() { clear_bar(); }

void ProgressDisplay::report(std::string_view phase, std::uint64_t done, std::uint64_t total) {
  if (targets_.people < 0 && targets_.programs < 0) return;
  const bool last = done >= total;
  std::unique_lock lock(mutex_, std::defer_lock);
  if (last)
    lock.lock();
  else if (!lock.try_lock())
    return;

  const Time now = clock_();
  const bool first = phase != phase_;
  if (first) {
    phase_ = phase;
    start_ = now;
    complete_ = false;
  }
  if (complete_) return;  // a late report of another thread
  complete_ = last;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  if (targets_.programs >= 0 && due(now, next_for_programs_, kProgramInterval, first, last))
    print_for_programs(done, total, seconds);
  // A phase of a moment is not worth a line.
  if (first && !targets_.terminal) next_for_people_ = now + std::chrono::seconds(static_cast<int>(kLineInterval));
  if (targets_.people >= 0 &&
      due(now, next_for_people_, targets_.terminal ? kBarInterval : kLineInterval, false, false))
    print_for_people(done, total, seconds);
}

bool ProgressDisplay::due(Time now, Time& next, double interval, bool first, bool last) {
  if (now < next && !first && !last) return false;
  next = now + std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(interval));
  return true;
}

void ProgressDisplay::print_for_people(std::uint64_t done, std::uint64_t total, double seconds) {
  const double share = total == 0 ? 1 : static_cast<double>(done) / static_cast<double>(total);
  const int percent = static_cast<int>(100 * share);
  if (!targets_.terminal) {
    write(targets_.people, fmt::format("pointsweep: {} {} %, {}\n", phase_, percent, figures(done, total, seconds)));
    return;
  }
  const auto filled = static_cast<std::size_t>(std::min(1.0, share) * kBarWidth);
  std::string line = fmt::format("{:<10} [{:-<{}}] {:3} %  {}", phase_, std::string(filled, '#'), kBarWidth, percent,
                                 figures(done, total, seconds));
  line.resize(std::min(line.size(), static_cast<std::size_t>(std::max(1, targets_.columns - 1))));
  write(targets_.people, "\r\x1b[K" + line);
  bar_shown_ = true;
}

void ProgressDisplay::print_for_programs(std::uint64_t done, std::uint64_t total, double seconds) {
  const nlohmann::ordered_json report{{"phase", phase_}, {"done", done}, {"total", total}, {"seconds", seconds}};
  write(targets_.programs, report.dump() + "\n");
}

void ProgressDisplay::say(std::string_view sentence) {
  const std::lock_guard lock(mutex_);
  clear_bar();
  if (targets_.people >= 0) write(targets_.people, fmt::format("pointsweep: {}\n", sentence));
}

void ProgressDisplay::clear_bar() {
  if (bar_shown_) write(targets_.people, "\r\x1b[K");
  bar_shown_ = false;
}

/// The terminal is gone: say nothing from now on.
void ProgressDisplay::write(int& descriptor, std::string_view text) {
  while (!text.empty() && descriptor >= 0) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written >= 0)
      text.remove_prefix(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      descriptor = -1;
  }
}

}  // namespace pointsweep
