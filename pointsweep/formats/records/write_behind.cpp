// SPDX-License-Identifier: MIT
#include "pointsweep/formats/records/write_behind.h"

namespace pointsweep {

void WriteBehind::write(std::vector<std::byte>& records) {
  wait();
  under_way_.swap(records);
  task_.emplace([this] {
    for (const auto& writer : writers_) writer->write(under_way_);
  });
}

void WriteBehind::wait() {
  if (!task_) return;
  task_->wait();
  task_.reset();
}

void WriteBehind::finish() {
  wait();
  for (const auto& writer : writers_) writer->finish();
}

std::uint64_t WriteBehind::bytes_written() const {
  std::uint64_t bytes = 0;
  for (const auto& writer : writers_) bytes += writer->bytes_written();
  return bytes;
}

}  // namespace pointsweep
