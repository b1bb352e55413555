// SPDX-License-Identifier: MIT
#include "pointsweep/order/distribution.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <numeric>

#include "pointsweep/cancellation.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kLeastChunk = 1024, kLargestChunk = 12288;  ///< in records

/// The box of the records that a thread has found for a list so far, on a separate cache line.
struct alignas(64) GrowingBox : Box {
  /// Adding 0 turns -0 into 0, so that the result does not depend on whether 0 or -0 came first.
  Box box() const { return {lo + Vec3{}, hi + Vec3{}}; }
};

/// A batch of records on its way from the source to the store, and the buffers in which a thread partitions the batch.
struct Chunk {
  Chunk(const PartitionInput& input, std::size_t capacity, std::size_t lists)
      : records(std::make_unique_for_overwrite<std::byte[]>(capacity * input.schema.stride)),
        sorted(std::make_unique_for_overwrite<std::byte[]>(capacity * input.record.schema().stride)),
        numbers(std::make_unique_for_overwrite<double[]>(4 * capacity)),
        list(std::make_unique_for_overwrite<std::uint16_t[]>(capacity)),
        place(std::make_unique_for_overwrite<std::uint32_t[]>(capacity)),
        begin(lists + 1),
        boxes(lists) {}

  std::uint64_t first = 0;
  std::size_t count = 0;
  std::uint64_t next = 0, end = 0;  ///< range of records that the thread has taken and not yet read
  std::unique_ptr<std::byte[]> records, sorted;
  std::unique_ptr<double[]> numbers;       ///< all x, then all y, all z, and all rows if the key is the row
  std::unique_ptr<std::uint16_t[]> list;   ///< for each record, its list
  std::unique_ptr<std::uint32_t[]> place;  ///< for each record, its place in `sorted`
  std::vector<std::uint32_t> begin;        ///< for each list, its first record in `sorted`
  std::vector<GrowingBox> boxes;           ///< for each list, the box of all its records that were in this chunk
};

class Distribution {
 public:
  Distribution(const PartitionInput& input, SlabStore& store)
      : input_(input),
        store_(store),
        position_(position_fields(input.schema, "the input")),
        finder_(input.splitters, input.spacing),
        lists_(finder_.pieces() + 1) {
    const unsigned threads = thread_count();
    const std::size_t per_record = input.schema.stride + input.record.schema().stride + 4 * sizeof(double) + 6;
    capacity_ = std::clamp(input.memory_bytes / threads / per_record, kLeastChunk, kLargestChunk);
    for (unsigned t = 0; t < threads; ++t) chunks_.emplace_back(input, capacity_, lists_);
  }

  void run() {
    parallel_for(chunks_.size(), [this](std::size_t i, unsigned) {
      Chunk& chunk = chunks_[i];
      try {
        const ReadRecords own = input_.for_thread ? input_.for_thread() : ReadRecords();
        while (own ? read(chunk, own) : read_in_turn(chunk)) partition(chunk);
      } catch (...) {
        failure_.note(chunk.first);
      }
    });
    failure_.rethrow();
  }

  std::vector<Box> boxes() const {
    std::vector<Box> result;
    for (std::size_t list = 0; list + 1 < lists_; ++list) {
      GrowingBox all;
      for (const auto& chunk : chunks_) all.include(chunk.boxes[list]);
      result.push_back(all.box());
    }
    return result;
  }

 private:
  /// Reads the next chunk of the source, one thread at a time. Returns false at the end of the source, and after a
  /// failure at an earlier row.
  bool read_in_turn(Chunk& chunk) {
    stop_if_cancelled();
    const std::lock_guard lock(reading_);
    if (!take(chunk, next_)) return false;
    input_.read(chunk.first, room(chunk));
    note(chunk.count);
    return true;
  }

  /// Reads a chunk with `own`, at the same time as other threads read theirs. Returns false at the end of the source.
  bool read(Chunk& chunk, const ReadRecords& own) {
    stop_if_cancelled();
    {
      const std::lock_guard lock(reading_);
      if (!take(chunk, input_.chunk_end && next_ < input_.count ? input_.chunk_end(next_) : next_)) return false;
    }
    own(chunk.first, room(chunk));
    const std::lock_guard lock(reading_);
    note(chunk.count);
    return true;
  }

  /// Takes the next records of the thread's own range; if none are left, begins a range of rows that no thread has
  /// taken. A new range ends at `end`, or where the chunk is full if `end` is not after next_. Returns false if no
  /// records are left, or if an earlier row has failed.
  bool take(Chunk& chunk, std::uint64_t end) {
    if (chunk.next == chunk.end) {
      if (next_ == input_.count) return false;
      chunk.next = next_;
      chunk.end = next_ = std::min(end > next_ ? end : next_ + capacity_, input_.count);
    }
    chunk.first = chunk.next;
    if (failure_.makes_needless(chunk.first)) return false;
    chunk.count = std::min<std::uint64_t>(capacity_, chunk.end - chunk.next);
    chunk.next += chunk.count;
    return true;
  }

  std::span<std::byte> room(const Chunk& chunk) const {
    return {chunk.records.get(), chunk.count * input_.schema.stride};
  }

  void note(std::size_t count) {
    read_ += count;
    if (input_.progress) input_.progress(read_);
  }

  void partition(Chunk& chunk) {
    classify(chunk);
    sort_by_list(chunk);
    append(chunk);
  }

  /// Finds the list of each record and grows the boxes.
  void classify(Chunk& chunk) const {
    double* x = chunk.numbers.get();
    double* y = x + capacity_;
    double* z = y + capacity_;
    decode_positions(position_, chunk.records.get(), input_.schema.stride, chunk.count, x, y, z);
    const double* key = x + static_cast<std::size_t>(input_.key) * capacity_;
    if (input_.key == SortKey::row) decode_rows(chunk, z + capacity_);
    const auto nonfinite = static_cast<std::uint16_t>(lists_ - 1);
    const bool check = input_.nonfinite_list.has_value();
    for (std::size_t i = 0; i < chunk.count; ++i) {
      // 0 * v is a zero unless v is NaN or infinite.
      const bool finite = !check || (0 * x[i] + 0 * y[i]) + 0 * z[i] == 0;
      const auto list = finite ? static_cast<std::uint16_t>(finder_.piece_of({x[i], y[i], z[i]}, key[i])) : nonfinite;
      chunk.list[i] = list;
      chunk.boxes[list].include(Vec3{x[i], y[i], z[i]});
    }
  }

  void decode_rows(const Chunk& chunk, double* rows) const {
    const std::byte* record = chunk.records.get();
    for (std::size_t i = 0; i < chunk.count; ++i, record += input_.schema.stride)
      rows[i] = static_cast<double>(row_of(input_.schema, record));
  }

  /// Makes the working records, sorted by list with a counting sort.
  void sort_by_list(Chunk& chunk) const {
    std::vector<std::uint32_t>& begin = chunk.begin;
    std::ranges::fill(begin, 0);
    for (std::size_t i = 0; i < chunk.count; ++i) ++begin[chunk.list[i] + std::size_t{1}];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (std::size_t i = 0; i < chunk.count; ++i) chunk.place[i] = begin[chunk.list[i]]++;
    // The loop has advanced begin[list] to the begin of the next list.
    std::copy_backward(begin.begin(), begin.end() - 1, begin.end());
    begin[0] = 0;
    input_.record.scatter(chunk.records.get(), input_.schema.stride, chunk.count, chunk.first, chunk.place.get(),
                          chunk.sorted.get());
  }

  void append(const Chunk& chunk) {
    const std::size_t stride = input_.record.schema().stride;
    for (std::size_t list = 0; list < lists_; ++list) {
      const std::size_t begin = chunk.begin[list], end = chunk.begin[list + 1];
      if (begin == end) continue;
      const std::size_t target = list + 1 < lists_ ? input_.first_list + list : *input_.nonfinite_list;
      store_.append(target, {chunk.sorted.get() + begin * stride, (end - begin) * stride});
    }
  }

  const PartitionInput& input_;
  SlabStore& store_;
  PositionFields position_;
  PieceFinder finder_;
  std::size_t lists_;         ///< number of pieces, plus one list for nonfinite points
  std::size_t capacity_ = 0;  ///< most records of a chunk
  std::uint64_t next_ = 0;    ///< number of the first record that no thread has taken
  std::uint64_t read_ = 0;    ///< number of records read
  FirstFailure failure_;      ///< keeps the failure at the lowest row
  std::mutex reading_;
  std::vector<Chunk> chunks_;  ///< one for each thread
};

}  // namespace

std::vector<Box> distribute(const PartitionInput& input, SlabStore& store) {
  Distribution distribution(input, store);
  distribution.run();
  return distribution.boxes();
}

}  // namespace pointsweep
