// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_frame.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/las/las_point_formats.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/row_error.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kCopiedAtOnce = std::uint64_t{1} << 20;
constexpr std::size_t kPointFormatAt = 104;
constexpr std::byte kCompressedBit{0x80};

constexpr std::size_t kRowsAtOnce = 256;
/// Number of rows that a thread encodes at a time.
constexpr std::size_t kTaskRows = 4096;
/// Byte offsets of the flags and the class in records of point formats 6 to 10.
constexpr std::size_t kFlagsAt = 15, kClassAt = 16;
constexpr std::byte kOverlapFlag{0x08}, kOverlapClass{12};

/// Returns whether a coordinate is farther from the grid than rounding errors of float64 explain: farther than the
/// tolerance of is_on_las_grid(), and than a thousandth of a step or 1e-9 of the coordinate (1e-9 if it is below 1),
/// whichever of these two is smaller.
bool is_beside_grid(double value, double scale, double offset) {
  const double steps = (value - offset) / scale;
  const double distance = std::abs(steps - std::nearbyint(steps)) * scale;
  return distance > std::min(1e-3 * scale, 1e-9 * std::max(1.0, std::abs(value))) &&
         !is_on_las_grid(value, scale, offset);
}

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
      layout_(lay_out_las(plan, points)),
      out_(plan.path, plan.overwrite, plan.temp_folder) {
  put_header();
  put(layout_.header.header_size, layout_.first_vlrs);
  std::uint64_t at = copy(layout_.before, layout_.header.header_size + layout_.first_vlrs.size());
  put(at, layout_.added_vlrs);
  at = copy(layout_.between, at + layout_.added_vlrs.size());
  put(at, layout_.provenance_vlrs);
  copy(layout_.after, at + layout_.provenance_vlrs.size());
}

void LasFrame::put(std::uint64_t at, std::span<const std::byte> bytes) {
  out_.write_at(at, bytes);
  bytes_written_ += bytes.size();
}

/// Copies a piece of the input to byte `to` of the output and returns the byte after the copy.
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
  if (came > planned_) fail_since_more_came();
}

void LasFrame::fail_since_more_came() const {
  fail("{}: {} points were announced, but more came; nothing was written.", path_, planned_);
}

std::uint64_t LasFrame::tail_bytes() const {
  std::uint64_t bytes = 0;
  for (const LasPiece& piece : layout_.tail) bytes += piece.size();
  return bytes;
}

void LasFrame::finish(const LasStatistics& points, std::uint64_t points_end, std::span<const std::byte> last) {
  const std::uint64_t laid_out = layout_.points_end(planned_);
  for (std::uint64_t* reference : {&layout_.header.evlr_start, &layout_.header.waveform_start})
    if (*reference >= laid_out) *reference = *reference - laid_out + points_end;
  put(copy(layout_.tail, points_end), last);
  points.put_into(layout_.header);
  put_header();
  out_.seal();
}

LasEncoder::LasEncoder(const LasLayout& layout, std::string path)
    : conversion_(layout.from, layout.to),
      positions_{layout.x, layout.y, layout.z},
      scale_(layout.header.scale),
      offset_(layout.header.offset),
      stride_in_(layout.from.stride),
      stride_out_(layout.to.stride),
      fitting_scale_(layout.fitting_scale),
      positions_change_(layout.positions_change),
      overlap_by_class_(layout.overlap_by_class),
      moved_(layout.points_moved),
      notes_rounding_(layout.grid_is_stated || layout.grid_is_coarse || (layout.points_moved && layout.keeps_scale)),
      missing_returns_(layout.missing_returns),
      path_(std::move(path)) {}

void LasEncoder::run(std::uint64_t row, const std::byte* from, std::byte* to, std::size_t count) const {
  if (positions_change_) check_positions(row, from, count);
  conversion_.run(from, to, count);
  if (missing_returns_ != std::byte{0})
    for (std::size_t i = 0; i < count; ++i) to[i * stride_out_ + kLasReturnByte] |= missing_returns_;
  if (overlap_by_class_)
    for (std::byte* record = to; record < to + count * stride_out_; record += stride_out_)
      if (record[kClassAt] == kOverlapClass) record[kFlagsAt] |= kOverlapFlag;
}

void LasEncoder::check_positions(std::uint64_t row, const std::byte* records, std::size_t count) const {
  std::array<std::array<double, kRowsAtOnce>, 3> xyz;
  for (std::size_t first = 0; first < count; first += kRowsAtOnce) {
    const std::size_t n = std::min(kRowsAtOnce, count - first);
    decode_positions(positions_, records + first * stride_in_, stride_in_, n, xyz[0].data(), xyz[1].data(),
                     xyz[2].data());
    for (std::size_t i = 0; i < n; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        const double value = xyz[static_cast<std::size_t>(axis)][i];
        if (!las_grid_reaches(value, scale_[axis], offset_[axis])) refuse(axis, row + first + i, value);
        if (!notes_rounding_ || rounds_) continue;
        if (is_beside_grid(value, scale_[axis], offset_[axis])) rounds_ = true;
      }
    }
  }
}

void LasEncoder::refuse(int axis, std::uint64_t row, double value) const {
  const std::string before = fmt::format("{}: {} of row ", path_, "xyz"[axis]);
  if (!std::isfinite(value))
    throw RowError(row,
                   {before, fmt::format(" is {}, which LAS cannot hold; write PLY, or remove such points.", value)});
  const std::string remedy = fitting_scale_ && (*fitting_scale_)[axis] > scale_[axis]
                                 ? fmt::format(" give --scale {}, which reaches all points,", (*fitting_scale_)[axis])
                                 : "";
  throw RowError(row, {before, fmt::format(" is {}, too far from the offset {} for the scale {} of this LAS file;{} "
                                           "write PLY, or leave out points that are far from the others.",
                                           value, offset_[axis], scale_[axis], remedy)});
}

std::string LasEncoder::rounding() const {
  if (!rounds_) return "";
  const double coarsest = std::max({scale_.x, scale_.y, scale_.z});
  const bool alike = scale_.x == scale_.y && scale_.y == scale_.z;
  const std::string steps =
      alike ? fmt::format("{}", scale_.x) : fmt::format("{} in x, {} in y and {} in z", scale_.x, scale_.y, scale_.z);
  return fmt::format("{}: {}coordinates are rounded to steps of {}, by at most {}.", path_, moved_ ? "moved " : "",
                     steps, coarsest / 2);
}

LasFamilyWriter::LasFamilyWriter(const OutputPlan& plan, LasPoints points)
    : frame_(plan, points), encoder_(frame_.layout(), plan.path.string()), statistics_(header().point_format) {
  bytes_written_ = frame_.bytes_written();
  warnings_ = frame_.layout().warnings;
}

void LasFamilyWriter::encode(const std::byte* from, std::byte* to, std::size_t count) {
  const std::size_t in = encoder_.record_bytes_in(), out = encoder_.record_bytes_out();
  std::vector<LasStatistics> of_tasks((count + kTaskRows - 1) / kTaskRows, LasStatistics(header().point_format));
  parallel_for_blocks(count, kTaskRows, [&](std::size_t first, std::size_t rows, unsigned) {
    encoder_.run(statistics_.count() + first, from + first * in, to + first * out, rows);
    of_tasks[first / kTaskRows].add(to + first * out, out, rows);
  });
  for (const LasStatistics& some : of_tasks) statistics_.add(some);
}

std::uint64_t LasFamilyWriter::put_chunk_table(std::uint64_t at, std::span<const LazLayout::ChunkSize> chunks) {
  std::byte table_at[kLazOffsetBytes];
  std::memcpy(table_at, &at, sizeof table_at);
  frame_.put(header().offset_to_points, table_at);
  const std::vector<std::byte> table = frame_.layout().laz->write_chunk_table(chunks);
  frame_.put(at, table);
  return at + table.size();
}

void LasFamilyWriter::finish_file(std::uint64_t points_end, std::span<const std::byte> last) {
  if (std::string rounding = encoder_.rounding(); !rounding.empty()) add_warning(std::move(rounding));
  frame_.finish(statistics_, points_end, last);
  bytes_written_ = frame_.bytes_written();
}

}  // namespace pointsweep
