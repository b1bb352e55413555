// SPDX-License-Identifier: MIT
/// Files that are written in the background while the caller makes the next records.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pointsweep/threads.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Passes records to several writers in the background. If a writer fails, the next call of write(), wait() or finish()
/// throws its error.
class WriteBehind {
 public:
  void add(std::unique_ptr<Writer> writer) { writers_.push_back(std::move(writer)); }
  bool empty() const { return writers_.empty(); }
  const std::vector<std::unique_ptr<Writer>>& writers() const { return writers_; }

  /// Waits until the previous records are written, then takes whole records and leaves a used buffer in `records`.
  void write(std::vector<std::byte>& records) {
    wait();
    under_way_.swap(records);
    task_.emplace([this] {
      for (const auto& writer : writers_) writer->write(under_way_);
    });
  }
  /// Waits until all records are written.
  void wait() {
    if (!task_) return;
    task_->wait();
    task_.reset();
  }
  /// Completes the files and gives them their names.
  void finish() {
    wait();
    for (const auto& writer : writers_) writer->finish();
  }
  /// Returns the bytes of all files. Must be called after finish().
  std::uint64_t bytes_written() const {
    std::uint64_t bytes = 0;
    for (const auto& writer : writers_) bytes += writer->bytes_written();
    return bytes;
  }

 private:
  std::vector<std::unique_ptr<Writer>> writers_;
  std::vector<std::byte> under_way_;
  std::optional<BackgroundTask> task_;  // declared last: the task ends before the members that it uses
};

}  // namespace pointsweep
