// SPDX-License-Identifier: MIT
#include "pointsweep/part/record_list.h"

#include <cstring>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kChunkRecords = 1024;
constexpr std::size_t kChecksumBytes = sizeof(std::uint64_t);
constexpr std::size_t kBytesAtOnce = 1 << 20;  ///< most bytes of one read; a larger chunk is read alone

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

void RecordList::read(std::uint64_t first, std::span<std::byte> records) const {
  while (!records.empty()) {
    if (first + records.size() / record_bytes_ > count_) fail("{}: is damaged.", key_);
    const bool holds_chunk = first % kChunkRecords == 0 && records.size() >= kChunkRecords * record_bytes_;
    const std::size_t n = holds_chunk ? read_whole_chunks(first, records) : read_in_chunk(first, records);
    records = records.subspan(n * record_bytes_);
    first += n;
  }
}

std::size_t RecordList::read_whole_chunks(std::uint64_t first, std::span<std::byte> records) const {
  const std::size_t records_bytes = kChunkRecords * record_bytes_, chunk_bytes = records_bytes + kChecksumBytes;
  const std::size_t most = std::max<std::size_t>(1, kBytesAtOnce / chunk_bytes);
  const std::size_t chunks = std::min(most, records.size() / records_bytes);
  std::vector<std::byte> bytes(chunks * chunk_bytes);
  source_->read_at(first / kChunkRecords * chunk_bytes, bytes);
  for (std::size_t c = 0; c < chunks; ++c) {
    const std::span<const std::byte> chunk = std::span(bytes).subspan(c * chunk_bytes, chunk_bytes);
    require_whole(chunk);
    std::memcpy(records.data() + c * records_bytes, chunk.data(), records_bytes);
  }
  return chunks * kChunkRecords;
}

std::size_t RecordList::read_in_chunk(std::uint64_t first, std::span<std::byte> records) const {
  const std::uint64_t number = first / kChunkRecords, at = first % kChunkRecords;
  const std::uint64_t count = std::min(kChunkRecords, count_ - number * kChunkRecords);
  const std::lock_guard lock(mutex_);
  if (number != chunk_number_) {
    chunk_number_ = ~std::uint64_t{0};
    chunk_.resize(count * record_bytes_ + kChecksumBytes);
    source_->read_at(number * (kChunkRecords * record_bytes_ + kChecksumBytes), chunk_);
    require_whole(chunk_);
    chunk_number_ = number;
  }
  const std::size_t n = std::min<std::size_t>(records.size() / record_bytes_, count - at);
  std::memcpy(records.data(), chunk_.data() + at * record_bytes_, n * record_bytes_);
  return n;
}

void RecordList::require_whole(std::span<const std::byte> chunk) const {
  const std::span<const std::byte> records = chunk.first(chunk.size() - kChecksumBytes);
  std::uint64_t checksum;
  std::memcpy(&checksum, records.data() + records.size(), kChecksumBytes);
  if (checksum_of(records) != checksum) fail("{}: is damaged.", key_);
}

}  // namespace pointsweep
