// SPDX-License-Identifier: MIT
/// External merge sort: sorts runs of records in memory, writes them to a Scratch, and merges the runs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/free_memory.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// Sorts records: add() takes each record, then finish() is called once, then next() returns the records in order. If
/// all records fit in memory, no Scratch is made. `Less` is a total order of the records.
template <class Record, class Less>
class SortedRecords {
 public:
  /// Makes a sorter for at most `count` records, which takes `memory_bytes`, or 4096 records if these are more.
  SortedRecords(MakeScratch make_scratch, std::uint64_t memory_bytes, std::uint64_t count, Less less = {})
      : make_scratch_(std::move(make_scratch)),
        most_(std::max<std::uint64_t>(kLeastRun, memory_bytes / sizeof(Record))),
        less_(less) {
    // The memory is reserved at once, because a growing vector holds its old and its new array: three times as much.
    records_.reserve(static_cast<std::size_t>(std::min(most_, count)));
  }

  void add(const Record& record) {
    records_.push_back(record);
    ++count_;
    if (records_.size() == most_) end_run();
  }
  /// Must be called after the last add() and before next().
  void finish() {
    if (!scratch_) return std::sort(records_.begin(), records_.end(), less_);
    if (!records_.empty()) end_run();
    free_memory_of(records_);
    for (Run& run : runs_) fill(run);
    for (std::size_t r = 0; r < runs_.size(); ++r) heap_.push_back(r);
    std::make_heap(heap_.begin(), heap_.end(), after());
  }
  std::uint64_t count() const { return count_; }
  /// Returns the next record in order; nullopt after the last record.
  std::optional<Record> next() {
    if (!scratch_) return at_ < records_.size() ? std::optional(records_[at_++]) : std::nullopt;
    if (heap_.empty()) return {};
    std::pop_heap(heap_.begin(), heap_.end(), after());
    Run& run = runs_[heap_.back()];
    const Record record = run.block[run.at++];
    if (run.at == run.block.size()) fill(run);
    run.block.empty() ? heap_.pop_back() : std::push_heap(heap_.begin(), heap_.end(), after());
    return record;
  }

 private:
  static constexpr std::uint64_t kLeastRun = 4096;
  struct Run {
    std::uint64_t first, end;        ///< range of the run's records in the scratch that are still to be read
    std::vector<Record> block = {};  ///< records read from the scratch; empty at the end of the run
    std::size_t at = 0;              ///< index in `block` of the next record
  };
  /// Returns the order of a heap of runs with the least next record in front.
  auto after() {
    return [this](std::size_t a, std::size_t b) {
      return less_(runs_[b].block[runs_[b].at], runs_[a].block[runs_[a].at]);
    };
  }
  void end_run() {
    stop_if_cancelled();
    if (!scratch_) scratch_ = make_scratch_();
    std::sort(records_.begin(), records_.end(), less_);
    scratch_->append(std::as_bytes(std::span(records_)));
    runs_.push_back({count_ - records_.size(), count_});
    records_.clear();
  }
  void fill(Run& run) {
    const std::uint64_t each = std::max<std::uint64_t>(64, most_ / runs_.size());
    run.block.resize(static_cast<std::size_t>(std::min(each, run.end - run.first)));
    run.at = 0;
    if (run.block.empty()) return;
    scratch_->read(run.first * sizeof(Record), std::as_writable_bytes(std::span(run.block)));
    run.first += run.block.size();
  }

  MakeScratch make_scratch_;
  std::uint64_t most_, count_ = 0;
  Less less_;
  std::vector<Record> records_;
  std::size_t at_ = 0;
  std::unique_ptr<Scratch> scratch_;
  std::vector<Run> runs_;
  std::vector<std::size_t> heap_;  ///< indices of the runs that are not yet merged to their end
};

}  // namespace pointsweep
