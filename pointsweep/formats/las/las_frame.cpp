// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_frame.h"

#include <algorithm>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kCopiedAtOnce = std::uint64_t{1} << 20;
constexpr std::size_t kPointFormatAt = 104;
constexpr std::byte kCompressedBit{0x80};

}  // namespace

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
