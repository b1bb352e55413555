// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/row_mask.h"

#include <algorithm>

namespace pointsweep {
namespace {

std::uint64_t blocks_of(std::uint64_t rows) { return (rows + RowSelection::kBlockRows - 1) / RowSelection::kBlockRows; }

RowSelection selection_in(const std::shared_ptr<RowFile>& file, std::uint64_t rows) {
  return {rows, [file](std::uint64_t block, std::span<std::byte> bits) { file->read(block, bits); }};
}

}  // namespace

RowMask::RowMask(std::uint64_t rows, const RowSelection* before, const SpillPlace& spill)
    : rows_(rows),
      file_(std::make_shared<RowFile>(blocks_of(rows), RowSelection::kBlockBytes, spill)),
      block_(RowSelection::kBlockBytes) {
  if (before != nullptr) before_.emplace(*before);
}

void RowMask::append(std::span<const std::uint8_t> kept) {
  for (const std::uint8_t k : kept) {
    while (before_ && next_ < rows_ && !before_->has(next_)) append_any(false);
    append_any(k != 0);
  }
}

void RowMask::append_any(bool kept) {
  const std::uint64_t i = next_++ % RowSelection::kBlockRows;
  if (kept) block_[i / 8] |= std::byte{1} << i % 8;
  if (i + 1 < RowSelection::kBlockRows) return;
  file_->append(block_);
  std::ranges::fill(block_, std::byte{0});
}

RowSelection RowMask::finish() {
  while (next_ < rows_) append_any(false);
  if (next_ % RowSelection::kBlockRows != 0) file_->append(block_);
  return selection_in(file_, rows_);
}

RowSelection RowMask::kept(std::uint64_t rows, const SpillPlace& kept) {
  return selection_in(std::make_shared<RowFile>(RowFile::kept(blocks_of(rows), RowSelection::kBlockBytes, kept)), rows);
}

std::uint64_t RowMask::bytes(std::uint64_t rows) { return blocks_of(rows) * (RowSelection::kBlockBytes + 8); }

}  // namespace pointsweep
