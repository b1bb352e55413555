// SPDX-License-Identifier: MIT
#include "pointsweep/connect/forest_log.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "pointsweep/cancellation.h"

namespace pointsweep {
namespace {

constexpr std::size_t kScratchBlock = 1 << 20;
constexpr std::uint32_t kFinished = ~std::uint32_t{0};

struct Merge {
  std::uint64_t row;
  std::uint32_t slot;
  std::uint32_t to_and_flips;  ///< twice the slot of the other supernode, plus 1 if signs differ; or kFinished
};

}  // namespace

ScratchRecords::ScratchRecords(std::unique_ptr<Scratch> scratch, std::size_t record_bytes)
    : scratch_(std::move(scratch)), bytes_(record_bytes) {}

void ScratchRecords::append(const void* record) {
  const auto* bytes = static_cast<const std::byte*>(record);
  block_.insert(block_.end(), bytes, bytes + bytes_);
  ++count_;
  if (block_.size() >= kScratchBlock) finish();
}

void ScratchRecords::finish() {
  if (!block_.empty()) scratch_->append(block_);
  block_.clear();
}

const std::byte* ScratchRecords::Backwards::next() {
  if (left_ == 0) {
    stop_if_cancelled();
    left_ = std::min<std::uint64_t>(first_, std::max<std::size_t>(1, kScratchBlock / records_.bytes_));
    if (left_ == 0) return nullptr;
    first_ -= left_;
    block_.resize(left_ * records_.bytes_);
    records_.read(first_, block_);
  }
  return block_.data() + --left_ * records_.bytes_;
}

ForestLog::ForestLog(const MakeScratch& make_scratch, std::size_t result_bytes)
    : merges_(make_scratch(), sizeof(Merge)),
      components_(make_scratch(), sizeof(FinishedComponent) + result_bytes),
      record_(components_.record_bytes()) {}

void ForestLog::merged(std::uint64_t row, std::uint32_t slot, std::uint32_t to, bool flips) {
  const Merge merge{row, slot, 2 * to + (flips ? 1 : 0)};
  merges_.append(&merge);
  slots_ = std::max({slots_, slot + 1, to + 1});
}

void ForestLog::finished(std::uint64_t row, std::uint32_t slot, const FinishedComponent& component,
                         const std::byte* result) {
  const Merge merge{row, slot, kFinished};
  merges_.append(&merge);
  slots_ = std::max(slots_, slot + 1);
  append(component, result);
}

void ForestLog::append(const FinishedComponent& component, const std::byte* result) {
  std::memcpy(record_.data(), &component, sizeof component);
  std::copy(result, result + (record_.size() - sizeof component), record_.data() + sizeof component);
  components_.append(record_.data());
}

void ForestLog::finish() {
  merges_.finish();
  components_.finish();
}

std::uint64_t ForestLog::bytes() const {
  return merges_.count() * merges_.record_bytes() + components_.count() * components_.record_bytes();
}

void ForestLog::for_each_point(
    const std::function<ComponentLabel(std::uint64_t component, const std::byte* record)>& label_of,
    const std::function<void(std::uint64_t row, const ComponentLabel& label)>& use) const {
  const std::size_t result_bytes = components_.record_bytes() - sizeof(FinishedComponent);
  std::vector<ComponentLabel> known(slots_);
  std::vector<std::byte> results(slots_ * result_bytes);
  std::uint64_t next = components_.count();
  ScratchRecords::Backwards components(components_), merges(merges_);
  while (const std::byte* record = merges.next()) {
    Merge merge;
    std::memcpy(&merge, record, sizeof merge);
    ComponentLabel& own = known[merge.slot];
    const std::byte* result;
    if (merge.to_and_flips == kFinished) {
      --next;
      const std::byte* component = components.next();
      own = label_of(next, component);
      result = component + sizeof(FinishedComponent);
    } else {
      own = known[merge.to_and_flips / 2];
      result = own.result;
      own.flips ^= merge.to_and_flips % 2 == 1;
    }
    std::byte* kept = results.data() + merge.slot * result_bytes;
    std::copy(result, result + result_bytes, kept);
    own.result = kept;
    use(merge.row, own);
  }
}

}  // namespace pointsweep
