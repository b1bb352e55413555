// SPDX-License-Identifier: MIT
#include "cli/verbs/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "pointsweep/cancellation.h"

namespace pointsweep {
namespace {

constexpr double kBarInterval = 0.1;                       // seconds between two bars on a terminal
constexpr double kLineInterval = 5;                        // seconds between two lines for people
constexpr double kProgramInterval = 0.2;                   // seconds between two lines for programs
constexpr std::size_t kLongestBar = 24, kShortestBar = 4;  // lengths of a bar in characters
constexpr int kNarrow = 60;                                // columns of a terminal, below which there is no bar

ProgressDisplay::Targets targets_of(const CommonOptions& options) {
  ProgressDisplay::Targets targets;
  targets.programs = options.progress_descriptor;
  targets.errors = STDERR_FILENO;
  if (options.quiet) return targets;
  targets.people = STDERR_FILENO;
  const char* const kind = std::getenv("TERM");
  targets.terminal = isatty(STDERR_FILENO) != 0 && kind != nullptr && std::string_view(kind) != "dumb";
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) targets.columns = size.ws_col;
  return targets;
}

/// Progress of a phase in numbers.
struct Figures {
  std::string_view phase;
  std::uint64_t done, total;  // numbers of points
  double seconds;

  double share() const { return total == 0 ? 1 : static_cast<double>(done) / static_cast<double>(total); }
  std::string percent() const { return fmt::format("{} %", static_cast<int>(100 * share())); }
  double rate() const { return seconds > 0 ? static_cast<double>(done) / seconds : 0; }
  /// Returns ", 0:02 left"; empty if the remaining time is unknown.
  std::string time_left() const {
    if (rate() <= 0 || done >= total) return "";
    return fmt::format(", {} left", duration_text(static_cast<double>(total - done) / rate()));
  }
  /// Returns a text like "8.40M of 20.0M points, 12.1M/s, 0:02 left".
  std::string text(std::string_view unit) const {
    const std::string counts =
        fmt::format("{} of {}{}", count_text(static_cast<double>(done)), count_text(static_cast<double>(total)), unit);
    return rate() <= 0 ? counts : fmt::format("{}, {}/s{}", counts, count_text(rate()), time_left());
  }
};

/// Returns a line of at most columns - 1 characters: a bar, if there is room for one, and the figures.
std::string bar_line(const Figures& figures, int columns) {
  const std::string head = fmt::format("{:<10} ", figures.phase),
                    tail = fmt::format("{:>5}  {}", figures.percent(), figures.text(""));
  const std::size_t most = static_cast<std::size_t>(std::max(columns, 1)) - 1;
  std::string narrow = figures.percent() + figures.time_left();
  narrow.resize(std::min(narrow.size(), most));
  if (columns < kNarrow || head.size() + tail.size() > most) return narrow;
  const std::size_t room = most - head.size() - tail.size(), frame = 3;  // "[] "
  if (room < kShortestBar + frame) return head + tail;
  const std::size_t length = std::min(room - frame, kLongestBar);
  const auto filled = static_cast<std::size_t>(std::min(1.0, figures.share()) * static_cast<double>(length));
  return fmt::format("{}[{:-<{}}] {}", head, std::string(filled, '#'), length, tail);
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
  if (complete_) return;  // ignores a late report of another thread
  complete_ = last;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  if (targets_.programs >= 0 && due(now, next_for_programs_, kProgramInterval, first, last))
    print_for_programs(done, total, seconds);
  // Without a terminal, a phase that ends within kLineInterval gets no line.
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
  const Figures figures{phase_, done, total, seconds};
  if (!targets_.terminal) {
    write(targets_.people, fmt::format("{} {}, {}\n", phase_, figures.percent(), figures.text(" points")));
    return;
  }
  const std::string line = bar_line(figures, targets_.columns);
  // Blanks overwrite the rest of a longer bar, since not every terminal has an escape sequence that clears a line.
  write(targets_.people, fmt::format("\r{:<{}}", line, shown_));
  shown_ = line.size();
}

void ProgressDisplay::print_for_programs(std::uint64_t done, std::uint64_t total, double seconds) {
  const nlohmann::ordered_json report{{"phase", phase_}, {"done", done}, {"total", total}, {"seconds", seconds}};
  write(targets_.programs, report.dump() + "\n");
}

void ProgressDisplay::say(Severity severity, std::string_view sentence) {
  const std::lock_guard lock(mutex_);
  clear_bar();
  write(severity == Severity::error ? targets_.errors : targets_.people, message_line(severity, sentence));
}

void ProgressDisplay::clear_bar() {
  if (shown_ > 0) write(targets_.people, "\r" + std::string(shown_, ' ') + "\r");
  shown_ = 0;
}

/// Writes a text to a descriptor. After a failure, for example of a closed terminal, the descriptor is not used again.
void ProgressDisplay::write(int& descriptor, std::string_view text) {
  if (descriptor >= 0 && write_all(descriptor, text) != 0) descriptor = -1;
}

std::function<void(const char*, std::uint64_t, std::uint64_t)> reporting_to(ProgressDisplay& display) {
  return [&display](const char* phase, std::uint64_t done, std::uint64_t total) {
    stop_if_cancelled();
    display.report(phase, done, total);
  };
}

}  // namespace pointsweep
