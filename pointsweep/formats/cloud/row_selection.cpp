// SPDX-License-Identifier: MIT
#include "pointsweep/formats/cloud/row_selection.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace pointsweep {
namespace {

bool is_set(std::span<const std::byte> bits, std::uint64_t i) {
  return (std::to_integer<unsigned>(bits[i / 8]) >> i % 8 & 1u) != 0;
}

std::uint64_t count_of(std::byte bits) { return static_cast<unsigned>(std::popcount(std::to_integer<unsigned>(bits))); }

}  // namespace

RowSelection::RowSelection(std::uint64_t rows, std::function<void(std::uint64_t, std::span<std::byte>)> read)
    : rows_(rows), read_bits_(std::move(read)), before_{0} {
  std::vector<std::byte> bits(kBlockBytes);
  for (std::uint64_t block = 0; block * kBlockRows < rows; ++block) {
    read_bits_(block, bits);
    std::uint64_t kept = 0;
    for (const std::byte b : bits) kept += count_of(b);
    before_.push_back(before_.back() + kept);
  }
}

std::uint64_t RowSelection::block_of(std::uint64_t kept) const {
  return static_cast<std::uint64_t>(std::ranges::upper_bound(before_, kept) - before_.begin()) - 1;
}

bool RowSelection::is_whole(std::uint64_t block) const {
  return before_[block + 1] - before_[block] == std::min(kBlockRows, rows_ - block * kBlockRows);
}

void SelectionCursor::load_bits(std::uint64_t block) {
  if (block == bits_of_) return;
  selection_->read_bits_(block, bits_);
  bits_of_ = block;
}

bool SelectionCursor::has(std::uint64_t row) {
  load_bits(row / RowSelection::kBlockRows);
  return is_set(bits_, row % RowSelection::kBlockRows);
}

/// Returns the row within `block` of the `kept`-th kept row of the block; both count from 0.
std::uint64_t SelectionCursor::place_in_block(std::uint64_t block, std::uint64_t kept) {
  load_bits(block);
  std::uint64_t i = 0;
  for (; count_of(bits_[i / 8]) <= kept; i += 8) kept -= count_of(bits_[i / 8]);
  for (; kept > 0 || !is_set(bits_, i); ++i) kept -= is_set(bits_, i);
  return i;
}

std::uint64_t SelectionCursor::row_of(std::uint64_t kept) {
  const std::uint64_t block = selection_->block_of(kept);
  return block * RowSelection::kBlockRows + place_in_block(block, kept - selection_->before_[block]);
}

std::uint64_t SelectionCursor::kept_before(std::uint64_t row) {
  if (row == selection_->rows()) return selection_->count();
  const std::uint64_t block = row / RowSelection::kBlockRows, end = row % RowSelection::kBlockRows;
  load_bits(block);
  std::uint64_t kept = selection_->before_[block], i = 0;
  for (; i + 8 <= end; i += 8) kept += count_of(bits_[i / 8]);
  for (; i < end; ++i) kept += is_set(bits_, i);
  return kept;
}

std::size_t SelectionCursor::read(std::uint64_t first, std::size_t stride, std::span<std::byte> records,
                                  const ReadAll& read_all) {
  const RowSelection& all = *selection_;
  const std::uint64_t left = first < all.count() ? all.count() - first : 0;
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(left, records.size() / stride));
  for (std::size_t done = 0; done < wanted;) {
    const std::uint64_t block = all.block_of(first + done), offset = first + done - all.before_[block];
    std::uint64_t end = block + 1;
    const bool whole = all.is_whole(block);
    const auto gives = [&] { return static_cast<std::size_t>(all.before_[end] - first) - done; };
    while (whole && end < all.blocks() && gives() < wanted - done && all.is_whole(end)) ++end;
    const std::size_t n = std::min(wanted - done, gives());
    const auto target = records.subspan(done * stride, n * stride);
    whole ? read_all(block * RowSelection::kBlockRows + offset, target)
          : read_in_block(block, offset, n, stride, target.data(), read_all);
    done += n;
  }
  return wanted;
}

/// Reads `n` of the kept rows of a block, from the `first`-th kept row on.
void SelectionCursor::read_in_block(std::uint64_t block, std::uint64_t first, std::size_t n, std::size_t stride,
                                    std::byte* to, const ReadAll& read_all) {
  const std::uint64_t begin = place_in_block(block, first), end = place_in_block(block, first + n - 1) + 1;
  records_.resize(std::max<std::size_t>(records_.size(), (end - begin) * stride));
  read_all(block * RowSelection::kBlockRows + begin, std::span(records_).first((end - begin) * stride));
  for (std::uint64_t i = begin; i < end; ++i) {
    if (!is_set(bits_, i)) continue;
    std::memcpy(to, records_.data() + (i - begin) * stride, stride);
    to += stride;
  }
}

}  // namespace pointsweep
