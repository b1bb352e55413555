// SPDX-License-Identifier: MIT
#include "cli/console/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

#include "pointsweep/program/process.h"

namespace pointsweep {
namespace {

constexpr long kPatience = 700'000'000;  ///< nanoseconds between the first signal and the end of the process

std::atomic<int> came{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may touch nothing else");
CancellationToken token;
timer_t hard_end_timer;
bool has_timer = false;

void remember(int signal) {
  came.store(signal, std::memory_order_relaxed);
  token.cancel();
  itimerspec once{};
  once.it_value.tv_nsec = kPatience;
  if (has_timer) timer_settime(hard_end_timer, 0, &once, nullptr);
}

/// Ends the process when the timer that the first signal has started expires: the run has not stopped by then, because
/// it waits for a disk or because an operator takes long. A SIGALRM without an earlier interruption is ignored.
void end_at_once(int) {
  if (interrupting_signal() == 0) return;
  remove_leftovers();
  constexpr char kSentence[] = "\nerror: stopped; what was not complete is removed\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kSentence, sizeof kSentence - 1);
  ::_exit(128 + interrupting_signal());
}

void set_timer() {
  struct sigaction action {};
  action.sa_handler = end_at_once;
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGALRM;
  has_timer = sigaction(SIGALRM, &action, nullptr) == 0 && timer_create(CLOCK_MONOTONIC, &event, &hard_end_timer) == 0;
}

}  // namespace

void catch_interrupts() {
  set_timer();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction present {};
    if (sigaction(signal, nullptr, &present) != 0 || present.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = remember;
    action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
    sigaction(signal, &action, nullptr);
  }
}

int interrupting_signal() { return came.load(std::memory_order_relaxed); }

const CancellationToken& interrupt_token() { return token; }

}  // namespace pointsweep
