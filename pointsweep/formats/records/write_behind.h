// SPDX-License-Identifier: MIT
/// Files written in the background while the next records are made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pointsweep/threads.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Passes records to several writers in the background. The call after a failure throws the error of the writer.
class WriteBehind {
 public:
  void add(std::unique_ptr<Writer> writer) { writers_.push_back(std::move(writer)); }
  bool empty() const { return writers_.empty(); }
  const std::vector<std::unique_ptr<Writer>>& writers() const { return writers_; }

  /// Waits until the previous records are written, then takes whole records and leaves a used buffer in `records`.
  void write(std::vector<std::byte>& records);
  /// Waits until all records are written.
  void wait();
  /// Completes the files and gives them their names.
  void finish();
  std::uint64_t bytes_written() const;  ///< after finish()

 private:
  std::vector<std::unique_ptr<Writer>> writers_;
  std::vector<std::byte> under_way_;
  std::optional<BackgroundTask> task_;  // last, so that it ends before the members that it uses
};

}  // namespace pointsweep
