// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/grouped_records.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <optional>
#include <utility>

#include "pointsweep/cancellation.h"

namespace pointsweep {
namespace {

constexpr std::size_t kPieceBytes = 1 << 20;
constexpr std::size_t kLeastRunBytes = 4096;

/// A header in a run, before the records of a group.
struct GroupHead {
  std::uint32_t group, count;
};

/// Returns the indices of the records sorted by group, ascending within a group.
std::vector<std::uint32_t> order_by_group(const std::vector<std::uint32_t>& group_of) {
  const std::uint32_t last = group_of.empty() ? 0 : *std::ranges::max_element(group_of);
  std::vector<std::uint32_t> next(std::size_t{last} + 2), order(group_of.size());
  for (const std::uint32_t group : group_of) ++next[group + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (std::uint32_t i = 0; i < group_of.size(); ++i) order[next[group_of[i]]++] = i;
  return order;
}

}  // namespace

/// A run that is read back in sequence.
class GroupedRecords::Run {
 public:
  Run(const Scratch& scratch, std::uint64_t begin, std::uint64_t end, std::size_t record_bytes, std::size_t room)
      : scratch_(&scratch), next_(begin), end_(end), record_bytes_(record_bytes), held_(room) {
    read_head();
  }

  bool has_more() const { return head_.has_value(); }
  /// Passes the records of `group` to `use`, if the run has any. Groups ascend from call to call.
  void give(std::uint32_t group, const Use& use) {
    while (head_ && head_->group == group) give_part(use);
  }

 private:
  /// Passes the records after the header to `use`.
  void give_part(const Use& use) {
    for (std::size_t left = head_->count; left > 0;) {
      require(record_bytes_);
      const std::size_t n = std::min(left, (filled_ - at_) / record_bytes_);
      use(head_->group, std::span(held_).subspan(at_, n * record_bytes_));
      at_ += n * record_bytes_;
      left -= n;
    }
    read_head();
  }

  /// Reads more of the run unless `bytes` bytes that are not used yet are in memory.
  void require(std::size_t bytes) {
    if (filled_ - at_ >= bytes) return;
    std::copy(held_.begin() + static_cast<std::ptrdiff_t>(at_), held_.begin() + static_cast<std::ptrdiff_t>(filled_),
              held_.begin());
    filled_ -= std::exchange(at_, 0);
    const std::size_t n = std::min<std::uint64_t>(held_.size() - filled_, end_ - next_);
    scratch_->read(next_, std::span(held_).subspan(filled_, n));
    next_ += n;
    filled_ += n;
  }

  void read_head() {
    head_.reset();
    if (at_ == filled_ && next_ == end_) return;
    require(sizeof(GroupHead));
    std::memcpy(&head_.emplace(), held_.data() + at_, sizeof(GroupHead));
    at_ += sizeof(GroupHead);
  }

  const Scratch* scratch_;
  std::uint64_t next_, end_;  ///< bytes [next_, end_) of the scratch are not read yet
  std::size_t record_bytes_;
  std::vector<std::byte> held_;
  std::size_t at_ = 0, filled_ = 0;  ///< part of held_ that was read and not used yet
  std::optional<GroupHead> head_;    ///< header of the next group; none at the end
};

GroupedRecords::GroupedRecords(std::size_t record_bytes, std::uint64_t expected, std::uint64_t memory_bytes,
                               MakeScratch make_scratch)
    : record_bytes_(record_bytes),
      expected_(std::max<std::uint64_t>(1, expected)),
      capacity_(std::clamp<std::uint64_t>(memory_bytes / (record_bytes + 2 * sizeof(std::uint32_t)), 1, 1u << 31)),
      memory_bytes_(memory_bytes),
      make_scratch_(std::move(make_scratch)) {}

std::byte* GroupedRecords::add(std::uint32_t group) {
  if (held() == capacity_) put_run_aside();
  if (held() == group_of_.capacity()) {  // doubling the capacity would exceed the budget for a while
    const std::size_t room = group_of_.empty() ? std::min<std::uint64_t>(capacity_, expected_) : capacity_;
    group_of_.reserve(room);
    records_.reserve(room * record_bytes_);
  }
  group_of_.push_back(group);
  records_.resize(records_.size() + record_bytes_);
  return records_.data() + records_.size() - record_bytes_;
}

void GroupedRecords::for_each_held(const Use& use) const {
  const std::vector<std::uint32_t> order = order_by_group(group_of_);
  const std::size_t most = std::max<std::size_t>(1, kPieceBytes / record_bytes_);
  std::vector<std::byte> piece;
  for (std::size_t i = 0; i < order.size();) {
    stop_if_cancelled();
    const std::uint32_t group = group_of_[order[i]];
    piece.clear();
    for (std::size_t n = 0; n < most && i < order.size() && group_of_[order[i]] == group; ++n, ++i) {
      const std::byte* const record = records_.data() + std::size_t{order[i]} * record_bytes_;
      piece.insert(piece.end(), record, record + record_bytes_);
    }
    use(group, piece);
  }
}

void GroupedRecords::put_run_aside() {
  if (!scratch_) scratch_ = make_scratch_();
  std::uint64_t end = run_ends_.empty() ? 0 : run_ends_.back();
  std::vector<std::byte> bytes;
  const auto append = [&] {
    scratch_->append(bytes);
    end += bytes.size();
    bytes.clear();
  };
  for_each_held([&](std::uint32_t group, std::span<const std::byte> records) {
    const GroupHead head{group, static_cast<std::uint32_t>(records.size() / record_bytes_)};
    const auto* const first = reinterpret_cast<const std::byte*>(&head);
    bytes.insert(bytes.end(), first, first + sizeof head);
    bytes.insert(bytes.end(), records.begin(), records.end());
    if (bytes.size() >= kPieceBytes) append();
  });
  append();
  run_ends_.push_back(end);
  records_.clear();
  group_of_.clear();
}

void GroupedRecords::for_each(const Use& use) {
  if (!scratch_) return for_each_held(use);
  if (held() != 0) put_run_aside();
  records_ = {};
  group_of_ = {};
  const std::size_t room =
      std::max({kLeastRunBytes, record_bytes_, std::min<std::size_t>(kPieceBytes, memory_bytes_ / run_ends_.size())});
  std::vector<Run> runs;
  std::uint64_t begin = 0;
  for (const std::uint64_t end : run_ends_)
    runs.emplace_back(*scratch_, std::exchange(begin, end), end, record_bytes_, room);
  std::uint64_t left = runs.size();
  for (std::uint32_t group = 0; left > 0; ++group) {
    stop_if_cancelled();
    left = 0;
    for (Run& run : runs) {
      run.give(group, use);
      left += run.has_more();
    }
  }
}

}  // namespace pointsweep
