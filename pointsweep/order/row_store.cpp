// SPDX-License-Identifier: MIT
#include "pointsweep/order/row_store.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/order/page_memory.h"
#include "pointsweep/order/slab_store.h"
#include "pointsweep/points/record_map.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr Encoding kRowStoreEncoding{"row store", 1};

using Consume = std::function<void(std::uint64_t first_row, std::span<const std::byte> records)>;

constexpr std::size_t kRunBytes = std::size_t{4} << 20;     ///< bytes of records in one call of `consume`
constexpr std::size_t kGoodBlockBytes = 65536;              ///< block size with which the disk writes efficiently
constexpr std::size_t kLeastBlockBytes = 4096;              ///< least block size: smaller writes are slow
constexpr std::size_t kCachedBytes = std::size_t{1} << 20;  ///< size of a bucket that fits in the cache, so that
                                                            ///< stores at random places are fast
constexpr std::size_t kPageBytes = 4096;
constexpr std::size_t kOffsetBytes = sizeof(std::uint32_t);  ///< each spilled record follows its index in the bucket
constexpr std::size_t kLineBytes = 64;                       ///< bytes of a cache line
constexpr std::size_t kAhead = 16;                           ///< number of records whose places are prefetched

std::uint64_t bytes_of(std::uint64_t rows, std::size_t record_bytes) {
  if (rows > std::numeric_limits<std::uint64_t>::max() / record_bytes)
    fail("{} rows of {} bytes are more than any memory holds; spill them.", rows, record_bytes);
  return rows * record_bytes;
}

/// Returns the bytes of the records that are used at once: at most kRunBytes, but at least one record.
std::size_t bytes_of_run(std::size_t record_bytes) {
  return std::max<std::size_t>(1, kRunBytes / record_bytes) * record_bytes;
}

void consume_in_runs(std::uint64_t first_row, std::span<const std::byte> records, std::size_t record_bytes,
                     const Consume& consume) {
  const std::size_t run = bytes_of_run(record_bytes);
  for (std::size_t at = 0; at < records.size(); at += run) {
    stop_if_cancelled();
    consume(first_row + at / record_bytes, records.subspan(at, std::min(run, records.size() - at)));
  }
}

/// Fills `records` with copies of `record`.
void repeat(std::span<const std::byte> record, std::span<std::byte> records) {
  if (std::ranges::count(record, record.front()) == std::ssize(record))
    return void(std::ranges::fill(records, record.front()));
  for (std::size_t at = 0; at < records.size(); at += record.size()) std::ranges::copy(record, records.data() + at);
}

bool is_zero(std::byte b) { return b == std::byte{0}; }

/// The store in memory: all rows as one array.
class RowArray {
 public:
  RowArray(std::uint64_t rows, const std::vector<std::byte>& fill)
      : record_bytes_(fill.size()), memory_(bytes_of(rows, fill.size())) {
    // All threads fill the array, so that the system provides all pages now. Otherwise the threads that store the first
    // records, which lie far apart, would wait for most of the pages.
    const bool zeroed = std::ranges::all_of(fill, is_zero);
    parallel_for_blocks(memory_.size(), bytes_of_run(record_bytes_), [&](auto first, auto n, unsigned) {
      const std::span<std::byte> block(memory_.data() + first, n);
      if (!zeroed) return repeat(fill, block);
      for (std::size_t at = 0; at < n; at += kPageBytes) const_cast<volatile std::byte&>(block[at]) = std::byte{0};
    });
  }

  void put(std::span<const std::uint64_t> rows, const std::byte* records) {
    with_fixed_size(record_bytes_, [&](auto size) {
      const std::size_t n = rows.size(), ahead = n < kAhead ? 0 : n - kAhead;
      for (std::size_t i = 0; i < ahead; ++i) {
        const std::byte* to = memory_.data() + rows[i + kAhead] * record_bytes_;
        for (std::size_t at = 0; at < record_bytes_; at += kLineBytes) __builtin_prefetch(to + at, 1);
        __builtin_prefetch(to + record_bytes_ - 1, 1);
        store<size()>(rows[i], records + i * record_bytes_);
      }
      for (std::size_t i = ahead; i < n; ++i) store<size()>(rows[i], records + i * record_bytes_);
    });
  }

  void drain(const Consume& consume) const {
    consume_in_runs(0, {memory_.data(), memory_.size()}, record_bytes_, consume);
  }

 private:
  template <std::size_t Bytes>
  void store(std::uint64_t row, const std::byte* record) {
    assert((row + 1) * record_bytes_ <= memory_.size());
    copy_bytes<Bytes>(memory_.data() + row * record_bytes_, record, record_bytes_);
  }

  std::size_t record_bytes_;
  PageMemory memory_;
};

/// The store in a spill file: a bucket holds the records of 2^shift_ consecutive rows in the order of put(). Until
/// drain(), half of `buffer_bytes` buffers the ends of the buckets. In drain(), each of several threads sorts a window
/// (a bucket, or a part that takes half of `buffer_bytes`) by row. Buckets fit in the cache if the buffers allow that
/// many. A bucket larger than a window is read once for each of its windows.
class RowBuckets {
 public:
  RowBuckets(std::uint64_t rows, std::vector<std::byte> fill, const SpillPlace& spill, std::size_t buffer_bytes)
      : RowBuckets(rows, std::move(fill), buffer_bytes) {
    const auto too_many = [&](std::size_t block_bytes) { return buckets() > buffer_bytes / 2 / block_bytes + 1; };
    shift_ = std::countr_zero(std::min<std::uint64_t>(window_rows_, std::bit_ceil(kCachedBytes / record_bytes_ + 1)));
    while (shift_ < 32 && too_many(kGoodBlockBytes) && (std::uint64_t{1} << shift_) < window_rows_) ++shift_;
    while (shift_ < 32 && too_many(kLeastBlockBytes)) ++shift_;
    window_rows_ = std::min(window_rows_, std::uint64_t{1} << shift_);
    store_ = std::make_unique<SlabStore>(buckets(), kOffsetBytes + record_bytes_, block_bytes(buffer_bytes), spill);
  }
  RowBuckets(Decoder& in, std::uint64_t rows, std::vector<std::byte> fill, const SpillPlace& kept,
             std::size_t buffer_bytes)
      : RowBuckets(rows, std::move(fill), buffer_bytes) {
    in.begin(kRowStoreEncoding);
    shift_ = in.get<std::int32_t>();
    if (shift_ < 0 || shift_ > 62) fail("The buckets of stored results are damaged.");
    window_rows_ = std::min(window_rows_, std::uint64_t{1} << shift_);
    store_ = std::make_unique<SlabStore>(in, kOffsetBytes + record_bytes_, block_bytes(buffer_bytes), kept);
    if (store_->slabs() != buckets()) fail("The buckets of stored results are damaged.");
  }

  void put(std::span<const std::uint64_t> rows, const std::byte* records) {
    constexpr std::size_t kBatch = 4096;
    for (std::size_t i = 0; i < rows.size(); i += kBatch)
      put_batch(rows.subspan(i, std::min(kBatch, rows.size() - i)), records + i * record_bytes_);
  }

  void drain(const Consume& consume) {
    store_->finish();  // frees the buffers of the buckets, so that the windows can use the memory
    const std::uint64_t window_bytes = std::min(rows_, window_rows_) * record_bytes_;
    const std::uint64_t windows = (rows_ + window_rows_ - 1) / window_rows_;
    const std::uint64_t at_once = std::clamp<std::uint64_t>(buffer_bytes_ / std::max<std::uint64_t>(window_bytes, 1), 2,
                                                            thread_count() + std::uint64_t{1});
    const PageMemory memory(std::min(windows, at_once) * window_bytes);
    const auto filled = [&](std::size_t w) {
      const std::uint64_t first = w * window_rows_;
      const std::span<std::byte> records(memory.data() + w % at_once * window_bytes,
                                         std::min(rows_ - first, window_rows_) * record_bytes_);
      if (!records.empty()) repeat(fill_, records);
      fill_window(first, records);
      return records;
    };
    Prefetch<std::span<std::byte>> ahead(filled, 0, windows, at_once - 1);
    for (std::uint64_t w = 0; w < windows; ++w) consume_in_runs(w * window_rows_, ahead.next(), record_bytes_, consume);
  }

  std::uint64_t spilled_bytes() const { return store_->spilled_bytes(); }

  void encode(Encoder& out) {
    store_->flush();
    out.begin(kRowStoreEncoding);
    out.put<std::int32_t>(shift_);
    store_->encode(out);
  }

 private:
  RowBuckets(std::uint64_t rows, std::vector<std::byte> fill, std::size_t buffer_bytes)
      : rows_(rows),
        record_bytes_(fill.size()),
        fill_(std::move(fill)),
        buffer_bytes_(buffer_bytes),
        window_rows_(std::bit_floor(std::max<std::size_t>(1, buffer_bytes / 2 / record_bytes_))) {}

  std::uint64_t buckets() const { return rows_ == 0 ? 0 : ((rows_ - 1) >> shift_) + 1; }
  std::size_t block_bytes(std::size_t buffer_bytes) const {
    return std::clamp<std::size_t>(buffer_bytes / 2 / std::max<std::uint64_t>(1, buckets()), kLeastBlockBytes,
                                   std::size_t{1} << 20);
  }

  /// Groups the batch by bucket (counting sort), so that each bucket is locked once.
  void put_batch(std::span<const std::uint64_t> rows, const std::byte* records) {
    const auto [least, greatest] = std::ranges::minmax_element(rows);
    const std::uint64_t first = *least >> shift_;
    const std::size_t entry = kOffsetBytes + record_bytes_;
    std::vector<std::uint32_t> begin((*greatest >> shift_) - first + 2);
    for (const std::uint64_t row : rows) ++begin[(row >> shift_) - first + 1];
    for (std::size_t b = 1; b < begin.size(); ++b) begin[b] += begin[b - 1];
    std::vector<std::uint32_t> end(begin.begin(), begin.end() - 1);
    std::vector<std::byte> grouped(rows.size() * entry);
    with_fixed_size(record_bytes_, [&](auto size) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        std::byte* to = grouped.data() + end[(rows[i] >> shift_) - first]++ * entry;
        const auto offset = static_cast<std::uint32_t>(rows[i] & ((std::uint64_t{1} << shift_) - 1));
        std::memcpy(to, &offset, kOffsetBytes);
        copy_bytes<size()>(to + kOffsetBytes, records + i * record_bytes_, record_bytes_);
      }
    });
    for (std::size_t b = 0; b < end.size(); ++b)
      if (end[b] != begin[b])
        store_->append(first + b, {grouped.data() + begin[b] * entry, (end[b] - begin[b]) * entry});
  }

  /// Copies the records of the rows from `window_first` on to their places. A window lies within one bucket.
  void fill_window(std::uint64_t window_first, std::span<std::byte> window) const {
    const std::uint64_t b = window_first >> shift_;
    const std::size_t entry = kOffsetBytes + record_bytes_;
    const std::uint64_t rows = window.size() / record_bytes_;
    const std::uint64_t count = store_->count(b);
    std::vector<std::byte> chunk(std::min<std::uint64_t>(count, std::max<std::size_t>(1, 65536 / entry)) * entry);
    for (std::uint64_t first = 0; first < count; first += chunk.size() / entry) {
      const std::size_t n = std::min<std::uint64_t>(chunk.size() / entry, count - first);
      store_->read(b, first, {chunk.data(), n * entry});
      with_fixed_size(record_bytes_, [&](auto size) {
        for (const std::byte *from = chunk.data(), *end = from + n * entry; from != end; from += entry) {
          std::uint32_t offset = 0;
          std::memcpy(&offset, from, kOffsetBytes);
          const std::uint64_t place = (b << shift_) + offset - window_first;  // wraps to a large number for rows below
                                                                              // the window
          if (place < rows)
            copy_bytes<size()>(window.data() + place * record_bytes_, from + kOffsetBytes, record_bytes_);
        }
      });
    }
  }

  std::uint64_t rows_;
  std::size_t record_bytes_;
  std::vector<std::byte> fill_;
  std::size_t buffer_bytes_;
  std::uint64_t window_rows_;
  int shift_ = 0;
  std::unique_ptr<SlabStore> store_;
};

}  // namespace

struct RowStore::State {
  std::unique_ptr<RowArray> array;
  std::unique_ptr<RowBuckets> buckets;
};

RowStore::RowStore(std::uint64_t rows, std::vector<std::byte> fill, const SpillPlace& spill, std::size_t buffer_bytes)
    : state_(std::make_unique<State>()) {
  if (spill)
    state_->buckets = std::make_unique<RowBuckets>(rows, std::move(fill), spill, buffer_bytes);
  else
    state_->array = std::make_unique<RowArray>(rows, fill);
}

RowStore::RowStore(Decoder& in, std::uint64_t rows, std::vector<std::byte> fill, const SpillPlace& kept,
                   std::size_t buffer_bytes)
    : state_(std::make_unique<State>()) {
  state_->buckets = std::make_unique<RowBuckets>(in, rows, std::move(fill), kept, buffer_bytes);
}

RowStore::~RowStore() = default;

void RowStore::put(std::span<const std::uint64_t> rows, std::span<const std::byte> records) {
  if (rows.empty()) return;
  state_->array ? state_->array->put(rows, records.data()) : state_->buckets->put(rows, records.data());
}

void RowStore::drain(const Consume& consume) {
  state_->array ? state_->array->drain(consume) : state_->buckets->drain(consume);
}

void RowStore::encode(Encoder& out) { state_->buckets->encode(out); }

std::uint64_t RowStore::spilled_bytes() const { return state_->buckets ? state_->buckets->spilled_bytes() : 0; }

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
