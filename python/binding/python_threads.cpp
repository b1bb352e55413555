// SPDX-License-Identifier: MIT
#include "python/binding/python_threads.h"

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <semaphore>
#include <thread>
#include <utility>

namespace nb = nanobind;

namespace pointsweep {

namespace {
std::atomic<bool> is_ending = false;
std::thread::id ending_thread;   ///< set before is_ending
std::atomic<int> attaching = 0;  ///< number of threads that have not seen is_ending and may wait for the interpreter
}  // namespace

Detached::Detached() : state_(PyEval_SaveThread()) {}

Detached::~Detached() {
  ++attaching;
  if (for_ever()) {
    --attaching;
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
  }
  PyEval_RestoreThread(state_);
  --attaching;
}

bool Detached::for_ever() { return is_ending && std::this_thread::get_id() != ending_thread; }

void attach_no_more() {
  ending_thread = std::this_thread::get_id();
  is_ending = true;
  PyThreadState* const state = PyEval_SaveThread();
  // In a forked process, threads that were about to attach exist no more, so the wait has an end.
  for (int tries = 0; attaching > 0 && tries < 1000; ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  PyEval_RestoreThread(state);
}

class PythonThreads::Thread {
 public:
  Thread() : thread_([this] { serve(); }) {}
  ~Thread() {
    given_.release();  // an empty function
    thread_.join();
  }

  void call(const std::function<void()>& work) {
    work_ = &work;
    given_.release();
    done_.acquire();
    if (const std::exception_ptr failed = std::exchange(failed_, nullptr)) std::rethrow_exception(failed);
  }

 private:
  void serve() {
    const nb::gil_scoped_acquire attached;
    while (const auto* work = next()) {
      try {
        (*work)();
      } catch (...) {
        failed_ = std::current_exception();
      }
      done_.release();
    }
  }

  const std::function<void()>* next() {
    const nb::gil_scoped_release others_run;
    given_.acquire();
    return std::exchange(work_, nullptr);
  }

  const std::function<void()>* work_ = nullptr;
  std::exception_ptr failed_;
  std::binary_semaphore given_{0}, done_{0};
  std::thread thread_;
};

PythonThreads::PythonThreads() = default;
PythonThreads::~PythonThreads() = default;

PythonThreads::Thread& PythonThreads::take() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) return *threads_.emplace_back(std::make_unique<Thread>());
  Thread* const last = idle_.back();
  idle_.pop_back();
  return *last;
}

void PythonThreads::call(const std::function<void()>& work) {
  Thread& thread = take();
  std::exception_ptr failed;
  try {
    thread.call(work);
  } catch (...) {
    failed = std::current_exception();
  }
  {
    const std::lock_guard lock(mutex_);
    idle_.push_back(&thread);
  }
  if (failed) std::rethrow_exception(failed);
}

}  // namespace pointsweep
