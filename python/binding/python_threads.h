// SPDX-License-Identifier: MIT
/// Threads that attach to the interpreter of Python: those that wait for the library without it, and those on which the
/// operators in Python of one run are called.
#pragma once

#include <nanobind/nanobind.h>

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace pointsweep {

/// Detaches the thread from the interpreter for a scope, so that other threads of Python run. If the interpreter ends
/// meanwhile, which only a daemon thread can see, the end of the scope blocks the thread for ever: the interpreter
/// would end a thread that attaches then in the middle of C++ code, which aborts the process.
class Detached {
 public:
  Detached();
  ~Detached();
  Detached(const Detached&) = delete;
  Detached& operator=(const Detached&) = delete;
  /// Returns whether the end of the scope would block the thread.
  static bool for_ever();

 private:
  PyThreadState* state_;
};

/// Lets no other thread attach at the end of a Detached any more, and waits for those that are about to. Must be called
/// before the interpreter ends.
void attach_no_more();

/// A thread that the interpreter has not started gets a new thread state, with new `threading.local` values, each time
/// that it attaches to the interpreter. The workers of a run are such threads, and the run does not own them. So a run
/// calls Python on the threads of a PythonThreads, which it owns: each keeps one thread state from its first call to
/// the end of the run. There are at most as many of them as workers that call at the same time.
class PythonThreads {
 public:
  PythonThreads();
  /// Ends the threads, which destroy their `threading.local` values. The calling thread must not be attached.
  ~PythonThreads();

  /// Calls work() on a thread attached to the interpreter, waits for its end, and throws what it throws. Several
  /// threads may call at once; they must not be attached.
  void call(const std::function<void()>& work);

 private:
  class Thread;
  Thread& take();

  std::mutex mutex_;
  std::vector<std::unique_ptr<Thread>> threads_;
  std::vector<Thread*> idle_;
};

}  // namespace pointsweep
