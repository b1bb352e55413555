// SPDX-License-Identifier: MIT
#include "pointsweep/order/row_file.h"

#include <cassert>
#include <cstring>
#include <utility>

namespace pointsweep {

RowFile::RowFile(std::uint64_t rows, std::size_t record_bytes, const SpillPlace& spill) : RowFile(record_bytes) {
  if (spill)
    file_ = std::make_unique<SpillFile>(spill);
  else
    memory_ = PageMemory(rows * record_bytes);
}

RowFile::RowFile(std::uint64_t rows, std::size_t record_bytes, ReadRecords read) : RowFile(record_bytes) {
  rows_ = rows;
  elsewhere_ = std::move(read);
}

RowFile RowFile::kept(std::uint64_t rows, std::size_t record_bytes, const SpillPlace& kept) {
  RowFile file(record_bytes);
  file.rows_ = rows;
  file.file_ = std::make_unique<SpillFile>(kept, rows * record_bytes);
  return file;
}

void RowFile::append(std::span<const std::byte> records) {
  if (!records.empty()) write(extend(records.size() / record_bytes_), records);
}

std::uint64_t RowFile::extend(std::uint64_t rows) {
  if (file_) file_->reserve(rows * record_bytes_);
  assert(file_ || (rows_ + rows) * record_bytes_ <= memory_.size());
  return std::exchange(rows_, rows_ + rows);
}

void RowFile::write(std::uint64_t row, std::span<const std::byte> records) {
  if (records.empty()) return;
  const std::uint64_t first = row * record_bytes_;
  assert(first + records.size() <= rows_ * record_bytes_);
  if (file_)
    file_->write(first, records);
  else
    std::memcpy(memory_.data() + first, records.data(), records.size());
}

void RowFile::read(std::uint64_t row, std::span<std::byte> records) const {
  if (records.empty()) return;
  const std::uint64_t first = row * record_bytes_;
  assert(first + records.size() <= rows_ * record_bytes_);
  if (elsewhere_)
    elsewhere_(row, records);
  else if (file_)
    file_->read(first, records);
  else
    std::memcpy(records.data(), memory_.data() + first, records.size());
}

}  // namespace pointsweep
