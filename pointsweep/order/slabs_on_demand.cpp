// SPDX-License-Identifier: MIT
#include "pointsweep/order/slabs_on_demand.h"

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/math/sort.h"
#include "pointsweep/order/slab_store.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

[[noreturn]] void fail_changed() {
  fail("an input was written to while it was read, so old and new points may be mixed; run again once it is complete.");
}

std::size_t block_bytes(const CountedSlabs& slabs, std::size_t record_bytes) {
  const std::uint64_t largest = slabs.points.empty() ? 0 : *std::ranges::max_element(slabs.points);
  return waiting_block_bytes(largest, record_bytes);
}

/// Buffers in which one thread sorts the records of a block by slab.
struct Partition {
  Partition(const PointSource& source, const std::vector<std::size_t>& wanted) : rows(source, wanted) {}

  BlockReader rows;
  std::vector<std::uint32_t> slab, place;  ///< of each record: slab after the block's first slab, place in `sorted`
  std::vector<std::uint32_t> begin;        ///< for each slab of the block, its first record in `sorted`
  std::vector<std::byte> sorted;
};

/// Consecutive records of a slab that come from one SlabBlock. Rows ascend within a run. The runs of a slab stand in
/// the order in which threads have decoded the blocks.
struct BlockRun {
  std::uint64_t first_row;
  std::size_t begin, end;  ///< range of bytes in the records of the slab
};

/// Returns the runs of `records`, ascending by row. `blocks` ascend by row.
std::vector<BlockRun> runs_by_row(const Schema& schema, std::span<const std::byte> records,
                                  const std::vector<SlabBlock>& blocks) {
  std::vector<BlockRun> runs;
  std::uint64_t begin = 0, end = 0;  // rows of the block of the last run
  for (std::size_t at = 0; at < records.size(); at += schema.stride) {
    const std::uint64_t row = row_of(schema, records.data() + at);
    if (row < begin || row >= end) {
      const auto block = std::ranges::upper_bound(blocks, row, {}, &SlabBlock::first_row) - 1;
      begin = block->first_row;
      end = block->first_row + block->rows;
      runs.push_back({row, at, at});
    }
    runs.back().end = at + schema.stride;
  }
  std::ranges::sort(runs, {}, &BlockRun::first_row);
  return runs;
}

void copy_by_row(const Schema& schema, std::span<const std::byte> records, const std::vector<SlabBlock>& blocks,
                 std::span<std::byte> out) {
  std::byte* to = out.data();
  for (const BlockRun& run : runs_by_row(schema, records, blocks)) {
    std::memcpy(to, records.data() + run.begin, run.end - run.begin);
    to += run.end - run.begin;
  }
}

}  // namespace

std::size_t waiting_block_bytes(std::uint64_t slab_points, std::size_t record_bytes) {
  constexpr std::size_t kBlocksOfSlab = 64, kLeast = 4096, kLargest = 16 << 10;
  return std::clamp<std::size_t>(slab_points * record_bytes / kBlocksOfSlab, kLeast, kLargest);
}

std::uint64_t most_waiting(const CountedSlabs& slabs, std::size_t ahead) {
  // For each slab, the number of points of the blocks whose first slab it is.
  std::vector<std::uint64_t> decoded(slabs.points.size() + 1);
  for (const SlabBlock& block : slabs.blocks) decoded[block.first_slab] += block.rows;
  std::uint64_t most = 0, read = 0, handed_over = 0;
  std::size_t next = 0;
  for (std::size_t slab = 0; slab < slabs.points.size(); ++slab) {
    for (; next < std::min(slab + std::max<std::size_t>(ahead, 1), slabs.points.size()); ++next) read += decoded[next];
    most = std::max(most, read - handed_over);
    handed_over += slabs.points[slab];
  }
  return most;
}

class SlabsOnDemand::State {
 public:
  State(const PointSource& source, const WorkingRecord& record, std::vector<std::size_t> wanted, int axis,
        CountedSlabs slabs, std::size_t ahead, std::uint64_t most_points)
      : source_(source),
        record_(record),
        wanted_(std::move(wanted)),
        axis_(axis),
        slabs_(std::move(slabs)),
        finder_(slabs_.splitters, &slabs_.spacing),
        ahead_(std::max<std::size_t>(ahead, 1)),
        most_points_(most_points),
        block_bytes_(block_bytes(slabs_, record.schema().stride)),
        by_slab_(slabs_.blocks.size()),
        begun_(slabs_.points.size()),
        left_(slabs_.points.size()) {
    std::iota(by_slab_.begin(), by_slab_.end(), std::uint32_t{0});
    std::ranges::stable_sort(by_slab_, {}, [&](std::uint32_t b) { return slabs_.blocks[b].first_slab; });
    waiting_.emplace(slabs_.points.size(), record_.schema().stride, block_bytes_, nullptr);
  }

  void read(std::size_t slab, std::span<std::byte> out) {
    if (begin(slab))
      hand_over(slab, out);
    else
      read_again(slab, out);
  }

 private:
  /// Returns true, and marks the slab as begun, if this is a read in order: the first read of a slab within the
  /// read-ahead. A read in order takes the waiting points; any other read decodes the blocks of the slab again.
  bool begin(std::size_t slab) {
    const std::lock_guard lock(mutex_);
    if (begun_[slab] || slab >= next_slab_ + ahead_) return false;
    begun_[slab] = true;
    while (next_slab_ < begun_.size() && begun_[next_slab_]) ++next_slab_;
    return true;
  }

  void hand_over(std::size_t slab, std::span<std::byte> out) {
    decode_blocks_of(slab);
    copy(*waiting_, slab, slab, out);
    waiting_->release(slab);
    const std::lock_guard lock(mutex_);
    if (--left_ == 0) waiting_.reset();
  }

  /// Decodes, one by one, the blocks with a first slab up to `slab` that no thread has taken. Then waits until other
  /// threads have decoded the blocks that they have taken.
  void decode_blocks_of(std::size_t slab) {
    std::unique_lock lock(mutex_);
    for (;;) {
      if (failure_) std::rethrow_exception(failure_);
      if (next_block_ < by_slab_.size() && slabs_.blocks[by_slab_[next_block_]].first_slab <= slab) {
        const SlabBlock& block = slabs_.blocks[by_slab_[next_block_++]];
        decoding_.push_back(block.first_slab);
        lock.unlock();
        decode(block);
        lock.lock();
        decoding_.erase(std::ranges::find(decoding_, block.first_slab));
        decoded_.notify_all();
      } else if (std::ranges::any_of(decoding_, [slab](std::uint32_t first) { return first <= slab; })) {
        decoded_.wait(lock);
      } else {
        return;
      }
    }
  }

  void decode(const SlabBlock& block) {
    try {
      partition(block, *waiting_, 0, slabs_.points.size());
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
      decoded_.notify_all();
      throw;
    }
  }

  /// Appends the points of a block that are in the slabs [first, end) to lists of `store`. List 0 takes the points of
  /// slab `first`.
  void partition(const SlabBlock& block, SlabStore& store, std::size_t first, std::size_t end) {
    stop_if_cancelled();
    std::unique_ptr<Partition> p = take_partition();
    p->rows.read(block.first_row, block.rows);
    find_slabs(block, *p);
    const std::size_t stride = record_.schema().stride;
    for (std::size_t s = std::max<std::size_t>(block.first_slab, first);
         s < std::min<std::size_t>(block.last_slab + std::size_t{1}, end); ++s) {
      const std::uint32_t begin = p->begin[s - block.first_slab], stop = p->begin[s - block.first_slab + 1];
      if (begin != stop) store.append(s - first, {p->sorted.data() + begin * stride, (stop - begin) * stride});
    }
    give_back(std::move(p));
  }

  /// Makes the working records of the block, sorted by slab with a counting sort, which keeps rows ascending.
  void find_slabs(const SlabBlock& block, Partition& p) const {
    const std::size_t n = block.rows, slabs = block.last_slab - block.first_slab + std::size_t{1};
    p.slab.resize(n);
    p.place.resize(n);
    p.begin.assign(slabs + 1, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 at = p.rows.position(i);
      if (!is_finite(at)) fail_changed();
      const std::uint32_t slab = slabs_.slab_of_piece[finder_.piece_of(at, at[axis_])];
      if (slab < block.first_slab || slab > block.last_slab) fail_changed();
      p.slab[i] = slab - block.first_slab;
      ++p.begin[p.slab[i] + std::size_t{1}];
    }
    std::partial_sum(p.begin.begin(), p.begin.end(), p.begin.begin());
    for (std::size_t i = 0; i < n; ++i) p.place[i] = p.begin[p.slab[i]]++;
    std::copy_backward(p.begin.begin(), p.begin.end() - 1, p.begin.end());
    p.begin[0] = 0;
    p.sorted.resize(std::max(p.sorted.size(), n * record_.schema().stride));
    record_.scatter(p.rows.records(), source_.schema.stride, n, block.first_row, p.place.data(), p.sorted.data());
  }

  /// Copies a slab, which is list `list` of the store, to `out`, ascending by row.
  void copy(const SlabStore& store, std::size_t slab, std::size_t list, std::span<std::byte> out) const {
    if (store.count(list) != slabs_.points[slab]) fail_changed();
    std::vector<std::byte> records(out.size());
    store.read(list, 0, records);
    copy_by_row(record_.schema(), records, slabs_.blocks, out);
  }

  /// Adjacent slabs [first, end) whose blocks were decoded again, in memory until other slabs replace them.
  struct Again {
    Again(std::size_t from, std::size_t to, std::size_t record_bytes, std::size_t block_bytes)
        : first(from), end(to), slabs(to - from, record_bytes, block_bytes, nullptr) {}
    std::size_t first, end;
    SlabStore slabs;
  };

  void read_again(std::size_t slab, std::span<std::byte> out) {
    std::shared_ptr<Again> made;
    {
      const std::lock_guard lock(again_mutex_);
      if (!again_ || slab < again_->first || slab >= again_->end) make_again(slab);
      made = again_;
    }
    copy(made->slabs, slab, slab - made->first, out);
  }

  void make_again(std::size_t slab) {
    again_.reset();
    const auto [first, end] = slabs_around(slab);
    auto made = std::make_shared<Again>(first, end, record_.schema().stride, block_bytes_);
    std::vector<const SlabBlock*> blocks;
    for (const SlabBlock& block : slabs_.blocks)
      if (block.first_slab < end && block.last_slab >= first) blocks.push_back(&block);
    parallel_for(blocks.size(),
                 [&](std::size_t b, unsigned) { partition(*blocks[b], made->slabs, made->first, made->end); });
    again_ = std::move(made);
  }

  /// Returns the range of slabs around `slab` that fits in memory, with up to most_points_ / 2 points on each side.
  /// While points wait for reads in order, the range is `slab` alone, since these points use the memory.
  std::pair<std::size_t, std::size_t> slabs_around(std::size_t slab) const {
    std::size_t first = slab, end = slab + 1;
    {
      const std::lock_guard lock(mutex_);
      if (left_ > 0) return {first, end};
    }
    for (std::uint64_t held = 0; first > 0 && held + slabs_.points[first - 1] <= most_points_ / 2;)
      held += slabs_.points[--first];
    for (std::uint64_t held = 0; end < slabs_.points.size() && held + slabs_.points[end] <= most_points_ / 2;)
      held += slabs_.points[end++];
    return {first, end};
  }

  std::unique_ptr<Partition> take_partition() {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        std::unique_ptr<Partition> p = std::move(free_.back());
        free_.pop_back();
        return p;
      }
    }
    return std::make_unique<Partition>(source_, wanted_);
  }

  void give_back(std::unique_ptr<Partition> p) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(p));
  }

  const PointSource source_;
  const WorkingRecord& record_;
  const std::vector<std::size_t> wanted_;
  const int axis_;
  const CountedSlabs slabs_;
  const PieceFinder finder_;
  const std::size_t ahead_;
  const std::uint64_t most_points_;
  const std::size_t block_bytes_;

  mutable std::mutex mutex_;                      ///< guards the members up to free_, except the lists of waiting_
  std::condition_variable decoded_;               ///< notified when a thread has decoded a block or has failed to
  std::vector<std::uint32_t> by_slab_;            ///< indices of the blocks, ascending by first slab
  std::size_t next_block_ = 0;                    ///< index in by_slab_ of the first block that no thread has taken
  std::vector<std::uint32_t> decoding_;           ///< first slabs of the blocks that threads are decoding
  std::exception_ptr failure_;                    ///< error in decoding a block; all later reads in order throw it
  std::vector<bool> begun_;                       ///< for each slab, whether its read in order has begun
  std::size_t next_slab_ = 0;                     ///< the first slab whose read in order has not begun
  std::size_t left_;                              ///< number of slabs whose read in order has not ended
  std::optional<SlabStore> waiting_;              ///< waiting points by slab; empty when all reads in order have ended
  std::vector<std::unique_ptr<Partition>> free_;  ///< partitions that no thread uses now
  std::mutex again_mutex_;                        ///< guards again_
  std::shared_ptr<Again> again_;
};

SlabsOnDemand::SlabsOnDemand(const PointSource& source, const WorkingRecord& record, std::vector<std::size_t> wanted,
                             int axis, CountedSlabs slabs, std::size_t ahead, std::uint64_t most_points)
    : state_(std::make_unique<State>(source, record, std::move(wanted), axis, std::move(slabs), ahead, most_points)) {}

SlabsOnDemand::~SlabsOnDemand() = default;

void SlabsOnDemand::read(std::size_t slab, std::span<std::byte> out) { state_->read(slab, out); }

std::uint64_t estimate_waiting(std::span<const RowBox> boxes, int axis, std::span<const Vec3> sample,
                               std::uint64_t points, std::uint64_t slab_points, std::size_t ahead) {
  if (sample.empty() || slab_points == 0) return points;
  std::vector<double> along;
  for (const Vec3& p : sample) along.push_back(p[axis]);
  sort_ascending(std::span(along));
  std::vector<std::pair<double, std::uint64_t>> begins;  // for each box: its least coordinate along the axis, and its
                                                         // rows
  for (const RowBox& box : boxes) {
    const double begin = box.box.lo[axis];
    begins.emplace_back(begin == begin ? begin : -Box::kInf, box.rows);
  }
  std::ranges::sort(begins);
  std::uint64_t most = 0, decoded = 0;
  std::size_t next = 0;
  for (std::uint64_t handed_over = 0; handed_over < points; handed_over += slab_points) {
    const std::uint64_t read = handed_over + slab_points * std::max<std::size_t>(ahead, 1);
    // Boxes are decoded if they begin before the end of the slabs being made, estimated as a quantile of the sample.
    const double share = static_cast<double>(read) / static_cast<double>(points);
    const auto at = static_cast<std::size_t>(share * static_cast<double>(along.size()));
    for (; next < begins.size() && (at >= along.size() || begins[next].first <= along[at]); ++next)
      decoded += begins[next].second;
    most = std::max(most, decoded - std::min(decoded, handed_over));
  }
  return std::min(most, points);
}

}  // namespace pointsweep
