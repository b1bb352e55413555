// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_frame.h"

#include <algorithm>
#include <cstring>

#include "pointsweep/fail.h"
#include "pointsweep/formats/las/las_point_formats.h"

namespace pointsweep {

namespace {

constexpr std::uint64_t kCopiedAtOnce = std::uint64_t{1} << 20;
constexpr std::size_t kPointFormatAt = 104;
constexpr std::byte kCompressedBit{0x80};

}  // namespace

LasStatistics::LasStatistics(int point_format) : return_mask_(las_return_mask(point_format)) {}

void LasStatistics::add(const std::byte* records, std::size_t stride, std::size_t count) {
  auto lo = lo_, hi = hi_;
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* record = records + i * stride;
    std::array<std::int32_t, 3> p;
    std::memcpy(p.data(), record, sizeof p);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], p[axis]);
      hi[axis] = std::max(hi[axis], p[axis]);
    }
    ++by_return_[static_cast<std::uint8_t>(record[kLasReturnByte]) & return_mask_];
  }
  lo_ = lo;
  hi_ = hi;
  count_ += count;
}

void LasStatistics::add(const LasStatistics& other) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lo_[axis] = std::min(lo_[axis], other.lo_[axis]);
    hi_[axis] = std::max(hi_[axis], other.hi_[axis]);
  }
  for (std::size_t r = 0; r < by_return_.size(); ++r) by_return_[r] += other.by_return_[r];
  count_ += other.count_;
}

void LasStatistics::put_into(LasHeader& header) const {
  set_counts(header, count_, by_return_);
  header.bounds = {{0, 0, 0}, {0, 0, 0}};
  if (count_ == 0) return;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    header.bounds.lo[axis] = lo_[a] * header.scale[axis] + header.offset[axis];
    header.bounds.hi[axis] = hi_[a] * header.scale[axis] + header.offset[axis];
  }
}

LasFrame::LasFrame(const OutputPlan& plan, LasPoints points)
    : path_(plan.path.string()),
      planned_(plan.count),
      extras_(plan.extras),
      layout_(lay_out_las(plan, points)),
      out_(plan.path, plan.overwrite) {
  put_header();
  std::uint64_t at = copy(layout_.before, layout_.header.header_size);
  put(at, layout_.added_vlrs);
  at = copy(layout_.between, at + layout_.added_vlrs.size());
  put(at, layout_.provenance_vlrs);
  copy(layout_.after, at + layout_.provenance_vlrs.size());
}

void LasFrame::put(std::uint64_t at, std::span<const std::byte> bytes) {
  out_.write_at(at, bytes);
  bytes_written_ += bytes.size();
}

/// Copies a piece of the input to byte `to` of the output and returns the byte after it.
std::uint64_t LasFrame::copy(const LasPiece& piece, std::uint64_t to) {
  for (std::uint64_t from = piece.begin; from < piece.end;) {
    scratch_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kCopiedAtOnce, piece.end - from)));
    layout_.input->read_at(from, scratch_);
    put(to, scratch_);
    from += scratch_.size();
    to += scratch_.size();
  }
  return to;
}

std::uint64_t LasFrame::copy(const std::vector<LasPiece>& pieces, std::uint64_t to) {
  for (const LasPiece& piece : pieces) to = copy(piece, to);
  return to;
}

void LasFrame::put_header() {
  std::vector<std::byte> header = serialize(layout_.header);
  if (layout_.laz) header[kPointFormatAt] |= kCompressedBit;
  put(0, header);
}

void LasFrame::require_count(std::uint64_t came) const {
  if (came < planned_) fail("{}: {} points were announced, but {} came; nothing was written.", path_, planned_, came);
  if (came > planned_) fail("{}: {} points were announced, but more came; nothing was written.", path_, planned_);
}

void LasFrame::finish(const LasStatistics& points, std::uint64_t points_end) {
  const std::uint64_t laid_out = layout_.points_end(planned_);
  for (std::uint64_t* reference : {&layout_.header.evlr_start, &layout_.header.waveform_start})
    if (*reference >= laid_out) *reference = *reference - laid_out + points_end;
  copy(layout_.tail, points_end);
  points.put_into(layout_.header);
  put_header();
  out_.commit();
}

}  // namespace pointsweep
