// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/divided_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/extended_errors.h"
#include "pointsweep/storage/local/output_file.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kMostWaitingBytes = 256 << 20;

}  // namespace

void require_files_possible(const Divider& divider, std::span<const DividedFile> files) {
  for (const DividedFile& file : files)
    if (file.own > 0) OutputFile::require_possible(divider.path_of(file.key), divider.plan().overwrite);
}

DividedFiles::DividedFiles(const Divider& divider, const std::vector<DividedFile>& files, std::uint64_t memory_bytes,
                           std::function<void(double share)> progress)
    : divider_(divider),
      files_(files),
      most_waiting_(std::min(kMostWaitingBytes, memory_bytes / 4)),
      progress_(std::move(progress)),
      outputs_(files.size(), [&](std::size_t file) { return divider.path_of(files[file].key); }) {
  for (const DividedFile& file : files_) all_ += file.all;
}

/// Returns a sentence that tells how many files are complete, to append to an error; empty if none is complete.
std::string DividedFiles::state() const {
  if (complete_ == 0) return "";
  const auto with_points = std::ranges::count_if(files_, [](const DividedFile& file) { return file.own > 0; });
  return fmt::format(" {} of {} outputs are complete and stay.", complete_.load(), with_points);
}

void DividedFiles::take(std::uint32_t file, std::span<const std::byte> records) {
  taken_ += records.size() / divider_.plan().schema.stride;
  if (progress_) progress_(static_cast<double>(taken_) / static_cast<double>(all_));
  if (files_[file].own > 0) extending_errors([&] { put(file, records); }, [&] { return state(); });
}

void DividedFiles::put(std::uint32_t number, std::span<const std::byte> records) {
  if (left_ == 0) begin(number);
  left_ -= records.size() / divider_.plan().schema.stride;
  if (!large_)
    return void(waiting_.back().records.insert(waiting_.back().records.end(), records.begin(), records.end()));
  large_->write(records);
  if (left_ == 0) complete_large(number);
}

void DividedFiles::begin(std::uint32_t number) {
  left_ = files_[number].all;
  const std::uint64_t bytes = left_ * divider_.plan().schema.stride;
  if (bytes > most_waiting_) {
    large_ = create_writer(divider_.plan_of(files_[number]));
    return;
  }
  if (waiting_bytes_ + bytes > most_waiting_) write_together();
  waiting_.push_back({number, {}});
  waiting_.back().records.reserve(bytes);
  waiting_bytes_ += bytes;
}

void DividedFiles::complete_large(std::uint32_t number) {
  const std::unique_ptr<Writer> writer = std::exchange(large_, nullptr);
  writer->finish();
  ++complete_;
  bytes_written_ += writer->bytes_written();
  warnings_.add(writer->warnings(), divider_.path_of(files_[number].key));
}

void DividedFiles::write_together() {
  std::vector<std::uint64_t> bytes(waiting_.size());
  std::vector<std::vector<std::string>> warnings(waiting_.size());
  parallel_for(waiting_.size(), [&](std::size_t i, unsigned) {
    stop_if_cancelled();
    const std::unique_ptr<Writer> writer = create_writer(divider_.plan_of(files_[waiting_[i].file]));
    writer->write(std::exchange(waiting_[i].records, {}));
    writer->finish();
    ++complete_;
    bytes[i] = writer->bytes_written();
    warnings[i] = writer->warnings();
  });
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    bytes_written_ += bytes[i];
    warnings_.add(warnings[i], divider_.path_of(files_[waiting_[i].file].key));
  }
  waiting_.clear();
  waiting_bytes_ = 0;
}

void DividedFiles::finish() {
  extending_errors([&] { write_together(); }, [&] { return state(); });
}

std::vector<std::string> DividedFiles::warnings() const {
  std::vector<std::string> sentences = warnings_.sentences();
  for (const DividedFile& file : files_)
    if (divider_.is_unplaced(file.key))
      sentences.push_back(fmt::format("{}: {} points have no finite x and y, and are in no tile.",
                                      divider_.path_of(file.key).string(), file.all));
  return sentences;
}

}  // namespace pointsweep
