// SPDX-License-Identifier: MIT
#include "pointsweep/part/record_list.h"

#include <algorithm>
#include <cstring>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kChunkRecords = 1024;
constexpr std::size_t kChecksumBytes = sizeof(std::uint64_t);

}  // namespace

RecordListWriter::RecordListWriter(Storage& storage, const std::string& key, std::size_t record_bytes)
    : object_(storage.create(key)), record_bytes_(record_bytes) {}

void RecordListWriter::append(std::span<const std::byte> records) {
  count_ += records.size() / record_bytes_;
  const std::size_t whole = kChunkRecords * record_bytes_;
  while (!records.empty()) {
    const std::size_t taken = std::min(records.size(), whole - chunk_.size());
    chunk_.insert(chunk_.end(), records.begin(), records.begin() + static_cast<std::ptrdiff_t>(taken));
    records = records.subspan(taken);
    if (chunk_.size() == whole) write_chunk();
  }
}

void RecordListWriter::write_chunk() {
  const std::uint64_t checksum = checksum_of(chunk_);
  object_->append(chunk_);
  object_->append(std::as_bytes(std::span(&checksum, 1)));
  chunk_.clear();
}

void RecordListWriter::seal() {
  if (!chunk_.empty()) write_chunk();
  object_->seal();
}

RecordList::RecordList(const Storage& storage, const std::string& key, std::size_t record_bytes)
    : key_(key), source_(storage.open(key)), record_bytes_(record_bytes) {
  const std::uint64_t whole = kChunkRecords * record_bytes_ + kChecksumBytes, rest = source_->size() % whole;
  count_ = source_->size() / whole * kChunkRecords;
  if (rest == 0) return;
  if (rest <= kChecksumBytes || (rest - kChecksumBytes) % record_bytes_ != 0) fail("{}: is damaged.", key_);
  count_ += (rest - kChecksumBytes) / record_bytes_;
}

void RecordList::read(std::uint64_t first, std::span<std::byte> records) {
  for (std::uint64_t n = records.size() / record_bytes_; n > 0;) {
    if (first >= count_) fail("{}: is damaged.", key_);
    if (first / kChunkRecords != chunk_number_) read_chunk(first / kChunkRecords);
    const std::uint64_t at = first % kChunkRecords;
    const std::uint64_t taken = std::min<std::uint64_t>(n, chunk_.size() / record_bytes_ - at);
    std::memcpy(records.data(), chunk_.data() + at * record_bytes_, taken * record_bytes_);
    records = records.subspan(taken * record_bytes_);
    first += taken;
    n -= taken;
  }
}

void RecordList::read_chunk(std::uint64_t number) {
  const std::uint64_t count = std::min(kChunkRecords, count_ - number * kChunkRecords);
  chunk_.resize(count * record_bytes_ + kChecksumBytes);
  chunk_number_ = ~std::uint64_t{0};
  source_->read_at(number * (kChunkRecords * record_bytes_ + kChecksumBytes), chunk_);
  std::uint64_t checksum;
  std::memcpy(&checksum, chunk_.data() + count * record_bytes_, kChecksumBytes);
  chunk_.resize(count * record_bytes_);
  if (checksum_of(chunk_) != checksum) fail("{}: is damaged.", key_);
  chunk_number_ = number;
}

}  // namespace pointsweep
