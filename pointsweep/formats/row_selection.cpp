// SPDX-License-Identifier: MIT
#include "pointsweep/formats/row_selection.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace pointsweep {
namespace {

bool is_set(const std::vector<std::byte>& bits, std::uint64_t i) {
  return (std::to_integer<unsigned>(bits[i / 8]) >> i % 8 & 1u) != 0;
}

}  // namespace

RowSelection::RowSelection(std::uint64_t rows, std::function<void(std::uint64_t, std::span<std::byte>)> read)
    : rows_(rows), read_bits_(std::move(read)), before_{0}, bits_(kBlockBytes) {
  for (std::uint64_t block = 0; block * kBlockRows < rows; ++block) {
    load_bits(block);
    std::uint64_t kept = 0;
    for (const std::byte b : bits_) kept += static_cast<unsigned>(std::popcount(std::to_integer<unsigned>(b)));
    before_.push_back(before_.back() + kept);
  }
}

std::uint64_t RowSelection::rows_in(std::uint64_t block) const {
  return std::min(kBlockRows, rows_ - block * kBlockRows);
}

void RowSelection::load_bits(std::uint64_t block) const {
  if (block == bits_of_) return;
  read_bits_(block, bits_);
  bits_of_ = block;
}

bool RowSelection::has(std::uint64_t row) const {
  load_bits(row / kBlockRows);
  return is_set(bits_, row % kBlockRows);
}

std::uint64_t RowSelection::row_of(std::uint64_t kept) const {
  const auto after = std::upper_bound(before_.begin(), before_.end(), kept);
  const auto block = static_cast<std::uint64_t>(after - before_.begin()) - 1;
  load_bits(block);
  std::uint64_t left = kept - before_[block], i = 0;
  for (; left > 0 || !is_set(bits_, i); ++i) left -= is_set(bits_, i);
  return block * kBlockRows + i;
}

void RowSelection::load_records(std::uint64_t block, std::size_t stride, const ReadAll& read_all) {
  if (block == records_of_) return;
  load_bits(block);
  records_.resize(rows_in(block) * stride);
  read_all(block * kBlockRows, records_);
  std::size_t kept = 0;
  for (std::uint64_t i = 0; i < rows_in(block); ++i) {
    if (!is_set(bits_, i)) continue;
    if (kept != i) std::memcpy(records_.data() + kept * stride, records_.data() + i * stride, stride);
    ++kept;
  }
  records_of_ = block;
}

std::size_t RowSelection::read(std::uint64_t first, std::size_t stride, std::span<std::byte> records,
                               const ReadAll& read_all) {
  const std::uint64_t left = first < count() ? count() - first : 0;
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(left, records.size() / stride));
  for (std::size_t done = 0; done < wanted;) {
    const auto after = std::upper_bound(before_.begin(), before_.end(), first + done);
    const auto block = static_cast<std::uint64_t>(after - before_.begin()) - 1;
    const std::uint64_t offset = first + done - before_[block];
    std::uint64_t end = block + 1;
    const bool whole = is_whole(block);
    const auto gives = [&] { return static_cast<std::size_t>(before_[end] - first) - done; };
    while (whole && end < blocks() && gives() < wanted - done && is_whole(end)) ++end;
    const std::size_t n = std::min(wanted - done, gives());
    const auto target = records.subspan(done * stride, n * stride);
    if (whole) {
      read_all(block * kBlockRows + offset, target);
    } else {
      load_records(block, stride, read_all);
      std::memcpy(target.data(), records_.data() + offset * stride, target.size());
    }
    done += n;
  }
  return wanted;
}

}  // namespace pointsweep
