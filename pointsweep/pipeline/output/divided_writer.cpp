// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/divided_writer.h"

#include <string>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/order/parallel_rows.h"
#include "pointsweep/pipeline/output/divided_files.h"

namespace pointsweep {

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
