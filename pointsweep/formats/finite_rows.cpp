// SPDX-License-Identifier: MIT
#include "pointsweep/formats/finite_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

bool can_be_nonfinite(const Field& field) {
  if (field.type == Type::f32 || field.type == Type::f64) return true;
  return !std::isfinite(0x1p64 * field.scale + field.bias);
}

void read_all_of(Reader& reader, std::uint64_t row, std::span<std::byte> records) {
  const std::size_t stride = reader.info().schema.stride;
  while (!records.empty()) {
    const std::size_t n = reader.read(row, records);
    if (n == 0) fail("{}: ends before its last point; run again when it is complete.", reader.info().path.string());
    records = records.subspan(n * stride);
    row += n;
  }
}

/// Calls `use(i)` for every record of a block that is not finite.
template <class Use>
void for_each_nonfinite_record(const PositionFields& position, std::span<const std::byte> records, std::size_t stride,
                               Box& bounds, Use use) {
  constexpr std::size_t kMost = FiniteRowIndex::kBlock;
  static thread_local double x[kMost], y[kMost], z[kMost];
  const std::size_t n = records.size() / stride;
  decode_positions(position, records.data(), stride, n, x, y, z);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 p{x[i], y[i], z[i]};
    is_finite(p) ? bounds.include(p) : use(i);
  }
}

}  // namespace

bool can_be_nonfinite(const Schema& schema, const std::filesystem::path& path) {
  const PositionFields p = position_fields(schema, path.string());
  return can_be_nonfinite(p.x) || can_be_nonfinite(p.y) || can_be_nonfinite(p.z);
}

FiniteRowIndex::FiniteRowIndex(Reader& reader, std::uint64_t first_row, NonfiniteRows& found,
                               const std::function<void(std::uint64_t)>& progress)
    : rows_(reader.info().count), before_{0} {
  const FileInfo& info = reader.info();
  const PositionFields position = position_fields(info.schema, info.path.string());
  std::vector<std::byte> records;
  for (std::uint64_t row = 0; row < rows_; row += kBlock) {
    const std::uint64_t n = std::min(kBlock, rows_ - row);
    records.resize(n * info.schema.stride);
    read_all_of(reader, row, records);
    std::uint64_t finite = n;
    for_each_nonfinite_record(position, records, info.schema.stride, found.bounds, [&](std::size_t i) {
      --finite;
      if (found.count++ == 0) found.first = fmt::format("row {} of {}", row + i, info.path.string());
      if (found.rows.size() < NonfiniteRows::kMostListed) found.rows.push_back(first_row + row + i);
    });
    before_.push_back(before_.back() + finite);
    if (progress) progress(row + n);
  }
}

std::size_t FiniteRowIndex::block_of(std::uint64_t row) const {
  return static_cast<std::size_t>(std::upper_bound(before_.begin(), before_.end(), row) - before_.begin()) - 1;
}

FiniteRows::FiniteRows(std::unique_ptr<Reader> all, FiniteRowIndex index)
    : all_(std::move(all)),
      index_(std::move(index)),
      position_(position_fields(all_->info().schema, all_->info().path.string())),
      loaded_(std::numeric_limits<std::size_t>::max()) {
  info_ = all_->info();
  info_.left_out = info_.count - index_.count();
  info_.count = index_.count();
}

std::size_t FiniteRows::read(std::uint64_t row, std::span<std::byte> records) {
  const std::size_t stride = info_.schema.stride;
  const std::size_t wanted = rows_for(row, records);
  for (std::size_t done = 0; done < wanted;) {
    const std::size_t block = index_.block_of(row + done);
    const auto offset = static_cast<std::size_t>(row + done - index_.before(block));
    std::size_t end = block + 1;
    const auto gives = [&] { return static_cast<std::size_t>(index_.before(end) - row) - done; };
    const bool whole = index_.is_whole(block);
    while (whole && gives() < wanted - done && index_.is_whole(end)) ++end;
    const std::size_t n = std::min(wanted - done, gives());
    const auto target = records.subspan(done * stride, n * stride);
    if (whole) {
      read_all_of(*all_, block * FiniteRowIndex::kBlock + offset, target);
    } else {
      load(block);
      std::memcpy(target.data(), block_.data() + offset * stride, target.size());
    }
    done += n;
  }
  return wanted;
}

std::uint64_t FiniteRows::input_row(std::uint64_t row) {
  const std::size_t block = index_.block_of(row);
  std::uint64_t at = row - index_.before(block);
  if (!index_.is_whole(block)) {
    load(block);
    for (const std::size_t gap : gaps_) at += gap <= at ? 1 : 0;
  }
  return block * FiniteRowIndex::kBlock + at;
}

void FiniteRows::load(std::size_t block) {
  if (block == loaded_) return;
  const std::size_t stride = info_.schema.stride;
  block_.resize(index_.rows_in(block) * stride);
  read_all_of(*all_, block * FiniteRowIndex::kBlock, block_);
  gaps_.clear();
  Box ignored;
  for_each_nonfinite_record(position_, block_, stride, ignored, [&](std::size_t i) { gaps_.push_back(i); });
  std::size_t kept = 0, gap = 0;
  for (std::size_t i = 0; i * stride < block_.size(); ++i) {
    if (gap < gaps_.size() && gaps_[gap] == i) {
      ++gap;
      continue;
    }
    if (kept != i) std::memcpy(block_.data() + kept * stride, block_.data() + i * stride, stride);
    ++kept;
  }
  loaded_ = block;
}

}  // namespace pointsweep
