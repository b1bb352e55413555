// SPDX-License-Identifier: MIT
#include "pointsweep/formats/records/record_writer.h"

#include <algorithm>
#include <cassert>

#include "pointsweep/fail.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kWrittenAtOnce = 256 << 10;  ///< bytes that a thread writes at a time

}  // namespace

void require_announced(const OutputPlan& plan, std::uint64_t row, std::uint64_t rows) {
  if (row > plan.count || rows > plan.count - row)
    fail("{}: more points came than the {} that were announced.", plan.path.string(), plan.count);
}

void require_all(const OutputPlan& plan, std::uint64_t rows_written) {
  if (rows_written < plan.count)
    fail("{}: only {} of the {} points that were announced came.", plan.path.string(), rows_written, plan.count);
}

RecordWriter::RecordWriter(const OutputPlan& plan, std::string_view header, const Schema& stored)
    : plan_(plan),
      file_(plan.path, plan.overwrite, plan.temp_folder),
      header_(header),
      header_bytes_(header.size()),
      stored_stride_(stored.stride),
      conversion_(plan.schema, stored) {
  bytes_written_ = header_bytes_;
}

void RecordWriter::write_header() {
  if (header_.empty()) return;
  file_.append(std::as_bytes(std::span(header_)));
  header_.clear();
}

void RecordWriter::write(std::span<const std::byte> records) { write_at(rows_written_, records); }

void RecordWriter::write_at(std::uint64_t row, std::span<const std::byte> records) {
  const std::size_t stride = plan_.schema.stride;
  assert(records.size() % stride == 0);
  const std::size_t rows = records.size() / stride;
  require_announced(plan_, row, rows);
  check(row, records);
  write_header();

  const std::uint64_t offset = header_bytes_ + row * stored_stride_;
  converted_.resize(std::max<std::size_t>(converted_.size(), thread_count()));
  const auto store = [&](std::size_t first, std::size_t n, unsigned worker) {
    std::span<const std::byte> stored = records.subspan(first * stride, n * stride);
    if (!conversion_.is_identity()) {
      std::vector<std::byte>& room = converted_[worker];
      room.resize(n * stored_stride_);
      conversion_.run(stored.data(), room.data(), n);
      stored = room;
    }
    file_.write_at(offset + first * stored_stride_, stored);
  };
  const std::size_t block = std::max<std::size_t>(1, kWrittenAtOnce / stored_stride_);
  if (file_.is_seekable())
    parallel_for_blocks(rows, block, store);
  else
    for (std::size_t first = 0; first < rows; first += block) store(first, std::min(block, rows - first), 0);
  rows_written_ += rows;
  bytes_written_ += std::uint64_t{rows} * stored_stride_;
}

void RecordWriter::finish() {
  require_all(plan_, rows_written_);
  write_header();
  file_.seal();
}

}  // namespace pointsweep
