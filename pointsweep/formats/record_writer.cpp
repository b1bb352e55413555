// SPDX-License-Identifier: MIT
#include "pointsweep/formats/record_writer.h"

#include <algorithm>
#include <cassert>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::size_t kConvertedBytes = 1 << 20;

}  // namespace

RecordWriter::RecordWriter(const OutputPlan& plan, std::string_view header, const Schema& stored)
    : plan_(plan),
      file_(plan.path, plan.overwrite),
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
  if (row > plan_.count || rows > plan_.count - row) {
    fail("{}: more points came than the {} that were announced.", plan_.path.string(), plan_.count);
  }
  check(row, records);
  write_header();

  const std::uint64_t offset = header_bytes_ + row * stored_stride_;
  if (conversion_.is_identity()) {
    file_.write_at(offset, records);
  } else {
    const std::size_t block = std::max<std::size_t>(1, kConvertedBytes / stored_stride_);
    for (std::size_t first = 0; first < rows; first += block) {
      const std::size_t n = std::min(block, rows - first);
      converted_.resize(std::max(converted_.size(), n * stored_stride_));
      conversion_.run(records.data() + first * stride, converted_.data(), n);
      file_.write_at(offset + first * stored_stride_, std::span(converted_).first(n * stored_stride_));
    }
  }
  rows_written_ += rows;
  bytes_written_ += std::uint64_t{rows} * stored_stride_;
}

void RecordWriter::finish() {
  if (rows_written_ < plan_.count) {
    fail("{}: only {} of the {} points that were announced came.", plan_.path.string(), rows_written_, plan_.count);
  }
  write_header();
  file_.commit();
}

}  // namespace pointsweep
