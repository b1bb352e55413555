// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/divided_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/order/parallel_rows.h"
#include "pointsweep/row_error.h"
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
  with_rows_of_output([&] { large_->write(records); });
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
  with_rows_of_output([&] { writer->finish(); });
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
    with_rows_of_output([&] {
      writer->write(std::exchange(waiting_[i].records, {}));
      writer->finish();
    });
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

DividedRecords::DividedRecords(const Divider& divider, std::uint64_t expected, std::uint64_t memory_bytes,
                               MakeScratch make_scratch)
    : divider_(divider), records_(divider.plan().schema.stride, expected, memory_bytes, std::move(make_scratch)) {}

void DividedRecords::write(std::span<const std::byte> records) {
  const std::size_t bytes = divider_.record_bytes();
  keys_.resize(records.size() / bytes);
  for_each_task(keys_.size(), [&](std::size_t first, std::size_t n) {
    for (std::size_t i = first; i < first + n; ++i) keys_[i] = divider_.key_of(records.data() + i * bytes);
  });
  came_ += keys_.size();
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (i % kTaskRows == 0) stop_if_cancelled();
    const std::byte* const record = records.data() + i * bytes;
    put(keys_[i], record, true);
    if (divider_.has_buffers())
      divider_.for_each_buffer(record, keys_[i], [&](const FileKey& key) { put(key, record, false); });
  }
}

void DividedRecords::put(FileKey key, const std::byte* record, bool is_own) {
  const auto [known, is_new] = file_of_.try_emplace(key, static_cast<std::uint32_t>(files_.size()));
  if (is_new) files_.push_back({key});
  DividedFile& file = files_[known->second];
  ++file.all;
  if (is_own && file.own++ == 0) divider_.require_few(++with_points_);
  divider_.copy(record, is_own, records_.add(known->second));
}

DividedWriter::DividedWriter(OutputPlan plan, const OutputDivision& division, DivisionRoom room)
    : progress_(std::exchange(plan.progress, {})),
      divider_(std::move(plan), division),
      room_(std::move(room)),
      records_(divider_, divider_.plan().count, room_.bytes / 2, room_.scratch) {
  divider_.require_writable();
}

void DividedWriter::finish() {
  const OutputPlan& plan = divider_.plan();
  if (records_.came() != plan.count)
    fail("{}: {} points were announced, but {} came; nothing was written.", plan.path.string(), plan.count,
         records_.came());
  require_files_possible(divider_, records_.files());
  const auto progress = [&](double share) {
    progress_(static_cast<std::uint64_t>(share * static_cast<double>(records_.came())));
  };
  DividedFiles files(divider_, records_.files(), room_.bytes, progress_ ? progress : std::function<void(double)>());
  records_.for_each([&](std::uint32_t file, std::span<const std::byte> records) { files.take(file, records); });
  files.finish();
  complete_ = files.complete();
  bytes_written_ = files.bytes_written();
  for (const std::string& sentence : files.warnings()) add_warning(sentence);
}

}  // namespace pointsweep
