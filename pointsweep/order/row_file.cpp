// SPDX-License-Identifier: MIT
#include "pointsweep/order/row_file.h"

#include <cassert>
#include <cstring>

namespace pointsweep {

RowFile::RowFile(std::uint64_t rows, std::size_t record_bytes, const SpillPlace& spill) : RowFile(record_bytes) {
  if (spill)
    file_ = std::make_unique<SpillFile>(spill);
  else
    memory_ = PageMemory(rows * record_bytes);
}

RowFile RowFile::kept(std::uint64_t rows, std::size_t record_bytes, const SpillPlace& kept) {
  RowFile file(record_bytes);
  file.end_ = rows * record_bytes;
  file.file_ = std::make_unique<SpillFile>(kept, file.end_);
  return file;
}

void RowFile::append(std::span<const std::byte> records) {
  if (records.empty()) return;
  if (file_) {
    file_->write(file_->reserve(records.size()), records);
  } else {
    assert(end_ + records.size() <= memory_.size());
    std::memcpy(memory_.data() + end_, records.data(), records.size());
  }
  end_ += records.size();
}

void RowFile::read(std::uint64_t row, std::span<std::byte> records) const {
  if (records.empty()) return;
  const std::uint64_t first = row * record_bytes_;
  assert(first + records.size() <= end_);
  if (file_)
    file_->read(first, records);
  else
    std::memcpy(records.data(), memory_.data() + first, records.size());
}

}  // namespace pointsweep
