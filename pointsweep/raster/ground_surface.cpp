// SPDX-License-Identifier: MIT
#include "pointsweep/raster/ground_surface.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/raster/row_filters.h"

namespace pointsweep {
namespace {

/// A copy of a stream in scratch, which the constructor reads to its end.
class KeptRows final : public RowStream {
 public:
  KeptRows(RowStream& from, std::unique_ptr<Scratch> scratch)
      : RowStream(from.columns()), scratch_(std::move(scratch)) {
    for (CellRows rows; from.next(rows);) {
      scratch_->append(std::as_bytes(std::span(rows.values)));
      scratch_->append(std::as_bytes(std::span(rows.marks)));
      blocks_.push_back(rows.rows);
    }
  }
  bool next(CellRows& out) override {
    out.rows = read_ == blocks_.size() ? 0 : blocks_[read_++];
    out.values.resize(out.rows * columns());
    out.marks.resize(out.rows * columns());
    take(std::as_writable_bytes(std::span(out.values)));
    take(std::as_writable_bytes(std::span(out.marks)));
    return out.rows > 0;
  }

 private:
  void take(std::span<std::byte> bytes) {
    scratch_->read(at_, bytes);
    at_ += bytes.size();
  }
  std::unique_ptr<Scratch> scratch_;
  std::vector<std::size_t> blocks_;
  std::size_t read_ = 0;
  std::uint64_t at_ = 0;
};

/// A stream of the minima with the marks of another stream, which has the same rows and columns.
class MarkedRows final : public RowStream {
 public:
  MarkedRows(const CellBand& lowest, std::unique_ptr<RowStream> marks)
      : RowStream(lowest.columns().size()), lowest_(lowest), marks_(std::move(marks)) {}
  bool next(CellRows& out) override {
    if (!lowest_.next(out)) return false;
    while (held_.size() < out.marks.size() && marks_->next(block_))
      held_.insert(held_.end(), block_.marks.begin(), block_.marks.end());
    const auto end = held_.begin() + static_cast<std::ptrdiff_t>(out.marks.size());
    std::copy(held_.begin(), end, out.marks.begin());
    held_.erase(held_.begin(), end);
    return true;
  }

 private:
  LowestRows lowest_;
  std::unique_ptr<RowStream> marks_;
  CellRows block_;
  std::vector<std::uint8_t> held_;
};

/// Returns the bytes per column that ground_surface() needs in addition to the openings: for both FilledRows, marks
/// that wait, and the rows that the caller holds.
std::size_t other_column_bytes(const GroundRule& rule) {
  const std::size_t block = kRowsAtOnce * (sizeof(double) + 1);
  return 2 * FilledRows::column_bytes(rule.reach()) + 6 * block + 2 * rule.radius + 4 * sizeof(double);
}

/// A sequence of filters, of which as many run together as fit in memory.
class Filters {
 public:
  Filters(std::unique_ptr<RowStream> first, std::uint64_t memory_bytes, const MakeScratch& make_scratch)
      : last_(std::move(first)), memory_bytes_(memory_bytes), make_scratch_(make_scratch) {}

  void add(std::size_t radius, double threshold, Opens opens) {
    const std::uint64_t bytes = last_->columns() * OpenedRows::column_bytes(radius);
    if (used_ > 0 && used_ + bytes > memory_bytes_) {
      last_ = std::make_unique<KeptRows>(*last_, make_scratch_());
      used_ = 0;
    }
    last_ = std::make_unique<OpenedRows>(std::move(last_), radius, threshold, opens);
    used_ += bytes;
  }
  std::unique_ptr<RowStream> finish() { return std::move(last_); }

 private:
  std::unique_ptr<RowStream> last_;
  std::uint64_t memory_bytes_, used_ = 0;
  const MakeScratch& make_scratch_;
};

}  // namespace

std::uint64_t least_ground_bytes(const GroundRule& rule, std::size_t columns) {
  return columns * (other_column_bytes(rule) + OpenedRows::column_bytes(std::max<std::size_t>(rule.radius, 1)));
}

void require_ground_memory(const GroundRule& rule, std::size_t columns, std::uint64_t memory_bytes) {
  if (const std::uint64_t least = least_ground_bytes(rule, columns); least > memory_bytes)
    fail(
        "ground: {} columns of cells take {} MB and {} MB are left for them: give {} MB more by --memory, or larger "
        "cells.",
        columns, (least >> 20) + 1, memory_bytes >> 20, ((least - memory_bytes) >> 20) + 1);
}

std::unique_ptr<RowStream> ground_surface(const CellBand& lowest, const GroundRule& rule, std::uint64_t memory_bytes,
                                          const MakeScratch& make_scratch) {
  const std::size_t columns = lowest.columns().size();
  require_ground_memory(rule, columns, memory_bytes);
  auto filled = std::make_unique<FilledRows>(std::make_unique<LowestRows>(lowest), rule.reach());
  if (lowest.height() < rule.least_height()) return filled;
  Filters filters(std::move(filled), memory_bytes - columns * other_column_bytes(rule), make_scratch);
  filters.add(1, GroundRule::kPitSlope * rule.cell, Opens::pit_marks);
  for (std::size_t r = 1; r <= rule.radius; ++r)
    filters.add(r, rule.slope * (rule.cell * static_cast<double>(r)), Opens::surface);
  return std::make_unique<FilledRows>(std::make_unique<MarkedRows>(lowest, filters.finish()), rule.reach());
}

void SurfaceWindow::move_to(std::uint64_t row) {
  while (!ended_ && first_ + rows_ <= row + around_) {
    ended_ = !from_->next(block_);
    values_.insert(values_.end(), block_.values.begin(), block_.values.end());
    rows_ += block_.rows;
    const std::uint64_t keep = row < around_ ? 0 : row - around_;
    if (keep <= first_) continue;
    const std::size_t old = std::min<std::size_t>(rows_, static_cast<std::size_t>(keep - first_));
    values_.erase(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(old * from_->columns()));
    first_ += old;
    rows_ -= old;
  }
}

}  // namespace pointsweep
