// SPDX-License-Identifier: MIT
/// Threads on which the operators in Python of one run are called.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace pointsweep {

/// Blocks the calling thread for ever if the interpreter is ending. Must be called before a thread attaches to the
/// interpreter that may be a daemon thread of Python or work for one: the interpreter would end such a thread in the
/// middle of C++ code, which aborts the process.
void wait_at_exit();

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
