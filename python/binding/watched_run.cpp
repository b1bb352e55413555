// SPDX-License-Identifier: MIT
#include "python/binding/watched_run.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "pointsweep/cancellation.h"
#include "python/binding/python_threads.h"

namespace nb = nanobind;

namespace pointsweep {
namespace {

constexpr auto kBetweenLooks = std::chrono::milliseconds(50);  // longest wait between checks for signals

/// The events since the last call of look(); of several reports of progress, the last.
struct Events {
  std::optional<Progress> progress;
  std::vector<std::string> warnings;
  bool done = false;
  bool any() const { return done || progress || !warnings.empty(); }
};

/// Stores the messages of the run for the waiting thread.
class Mailbox final : public Observer {
 public:
  void on_progress(const Progress& progress) override {
    put([&](Events& events) { events.progress = progress; });
  }
  void on_warning(const std::string& sentence) override {
    put([&](Events& events) { events.warnings.push_back(sentence); });
  }
  void done() {
    put([](Events& events) { events.done = true; });
  }

  /// Waits until something has come, for kBetweenLooks at most.
  Events look() {
    std::unique_lock lock(mutex_);
    came_.wait_for(lock, kBetweenLooks, [&] { return events_.any(); });
    return std::exchange(events_, {});
  }

 private:
  template <class Change>
  void put(Change change) {
    const std::lock_guard lock(mutex_);
    change(events_);
    came_.notify_one();
  }

  std::mutex mutex_;
  std::condition_variable came_;
  Events events_;
};

void call_back(const Callbacks& callbacks, const Events& events) {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
  for (const std::string& sentence : events.warnings)
    if (!callbacks.warn.is_none()) callbacks.warn(sentence.c_str());
  if (events.progress && !callbacks.progress.is_none())
    callbacks.progress(events.progress->phase, events.progress->done, events.progress->total);
}

}  // namespace

void watch(const Callbacks& callbacks, const std::function<void(Observer&)>& work) {
  Mailbox mailbox;
  std::exception_ptr failed, raised;
  std::thread worker([&] {
    try {
      work(mailbox);
    } catch (...) {
      failed = std::current_exception();
    }
    mailbox.done();
  });
  for (bool done = false; !done;) {
    Events events;
    {
      const Detached others_run;
      events = mailbox.look();
      if (Detached::for_ever()) mailbox.cancel();
    }
    done = events.done;
    if (raised) continue;
    try {
      call_back(callbacks, events);
    } catch (...) {
      raised = std::current_exception();
      mailbox.cancel();
    }
  }
  {
    const Detached others_run;
    worker.join();
  }
  if (raised) std::rethrow_exception(raised);
  if (failed) std::rethrow_exception(failed);
}

void watch_reports(const Callbacks& callbacks, const std::function<void(Observer&, const Report&)>& work) {
  watch(callbacks, [&](Observer& observer) {
    const CancellationScope scope(&observer.token());
    work(observer, [&](const char* phase, std::uint64_t done, std::uint64_t total) {
      stop_if_cancelled();
      observer.on_progress({phase, done, total, 0});
    });
  });
}

}  // namespace pointsweep
