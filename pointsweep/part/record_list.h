// SPDX-License-Identifier: MIT
/// A list of records of one size in an object of a storage. Records are appended one after another and read at any
/// index; each chunk of records has a checksum.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// Writes a list, which becomes readable when seal() is called.
class RecordListWriter {
 public:
  /// `record_bytes`: greater than 0.
  RecordListWriter(Storage& storage, const std::string& key, std::size_t record_bytes);
  /// Appends whole records.
  void append(std::span<const std::byte> records);
  std::uint64_t count() const { return count_; }
  void seal();

 private:
  void write_chunk();

  std::unique_ptr<Unsealed> object_;
  std::size_t record_bytes_;
  std::uint64_t count_ = 0;
  std::vector<std::byte> chunk_;
};

/// Reads a list. Thread-safe.
class RecordList {
 public:
  /// Opens the list under `key`. Throws Error if its size does not fit records of `record_bytes`.
  RecordList(const Storage& storage, const std::string& key, std::size_t record_bytes);
  std::uint64_t count() const { return count_; }
  /// Fills `records` with the records from number `first` on. Throws Error, which calls the object damaged, if the list
  /// ends earlier or a checksum is wrong.
  void read(std::uint64_t first, std::span<std::byte> records) const;

 private:
  std::size_t read_whole_chunks(std::uint64_t first, std::span<std::byte> records) const;
  std::size_t read_in_chunk(std::uint64_t first, std::span<std::byte> records) const;
  void require_whole(std::span<const std::byte> chunk) const;

  std::string key_;
  std::unique_ptr<Source> source_;
  std::size_t record_bytes_;
  std::uint64_t count_ = 0;
  mutable std::mutex mutex_;
  mutable std::uint64_t chunk_number_ = ~std::uint64_t{0};
  mutable std::vector<std::byte> chunk_;  ///< records of the chunk `chunk_number_`, then their checksum
};

/// Calls use(first, records) for all records of a list in order, some at a time; `first` is the number of the first
/// record of a piece. Record: a type whose bytes the list stores.
template <class Record, class Use>
void for_each_piece(const RecordList& list, const Use& use) {
  constexpr std::uint64_t kAtOnce = 4096;
  std::vector<Record> records;
  for (std::uint64_t first = 0; first < list.count(); first += records.size()) {
    stop_if_cancelled();
    records.resize(std::min(kAtOnce, list.count() - first));
    list.read(first, std::as_writable_bytes(std::span(records)));
    use(first, std::span<const Record>(records));
  }
}

}  // namespace pointsweep
