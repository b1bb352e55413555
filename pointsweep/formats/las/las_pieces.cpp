// SPDX-License-Identifier: MIT
/// The parts of a LAS output around its points: the statement of the coordinate reference system, new VLRs, and pieces
/// copied from the input.
#include <algorithm>
#include <cstring>
#include <limits>
#include <span>
#include <string>

#include "pointsweep/fail.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/las/copc_layout.h"
#include "pointsweep/formats/las/las_layout.h"
#include "pointsweep/formats/las/las_point_formats.h"
#include "pointsweep/formats/las/las_vlrs.h"
#include "pointsweep/formats/provenance.h"

namespace pointsweep {
namespace {

class PiecePlacer {
 public:
  PiecePlacer(const OutputPlan& plan, LasPoints points, const LasParts* input, const LasDescriptions& descriptions,
              LasLayout& layout)
      : plan_(plan), points_(points), input_(input), descriptions_(descriptions), layout_(layout) {}

  void place() {
    LasHeader& header = layout_.header;
    if (points_ == LasPoints::nodes) keep_standard_header();
    choose_crs();
    warn_of_waveforms();
    if (!descriptions_.keeps_records) warn_of_unnamed_bytes();
    const std::uint32_t removed = input_ != nullptr ? place_input() : 0;
    std::uint32_t added = 0;
    if (points_ == LasPoints::nodes) {
      layout_.first_vlrs = las_vlr(kCopcUser, kCopcRecord, "COPC info", std::vector<std::byte>(kCopcInfoBytes));
      ++added;
    }
    if (points_ != LasPoints::plain) {
      add_laszip_vlr();
      ++added;
    }
    if (descriptions_.extended) {
      add_extra_bytes_vlr();
      ++added;
    }
    added += add_crs_vlrs();
    added += add_provenance_vlrs();
    if (added != 0 || removed != 0) {
      header.vlr_count = (input_ != nullptr ? input_->vlrs.count : 0) + added - removed;
    }
    const std::uint64_t points = header.header_size + layout_.first_vlrs.size() + size_of_all(layout_.before) +
                                 layout_.added_vlrs.size() + size_of_all(layout_.between) +
                                 layout_.provenance_vlrs.size() + layout_.after.size();
    if (points > std::numeric_limits<std::uint32_t>::max()) {
      fail("{}: the header and VLRs would take {} bytes, and LAS allows 4294967295; write PLY.", plan_.path.string(),
           points);
    }
    header.offset_to_points = static_cast<std::uint32_t>(points);
    if (input_ != nullptr) {
      move_reference(header.evlr_start);
      move_reference(header.waveform_start);
      // In LAS 1.3, waveforms are the only extended VLR, which only LAS 1.4 counts.
      if (header.minor >= 4 && header.evlr_count == 0 && header.waveform_start >= layout_.points_end(plan_.count)) {
        header.evlr_count = 1;
        header.evlr_start = header.waveform_start;
      }
    }
    if (points_ == LasPoints::nodes) add_hierarchy();
  }

 private:
  /// Removes the bytes after the standard header, since readers of COPC expect the COPC VLR directly after it. Removes
  /// the reference to waveforms, for which the point formats of COPC have no fields.
  void keep_standard_header() {
    LasHeader& header = layout_.header;
    if (header.header_size > standard_header_size(4))
      layout_.warnings.push_back(
          fmt::format("{}: {} bytes after the header of the input are left out; COPC has no place for them.",
                      plan_.path.string(), header.header_size - standard_header_size(4)));
    header.header_size = standard_header_size(4);
    header.bytes.resize(header.header_size);
    header.waveform_start = 0;
    header.global_encoding = static_cast<std::uint16_t>(header.global_encoding & ~kLasWaveformBits);
  }

  /// Chooses the statements of the coordinate reference system that the file gets in addition to the input's VLRs, and
  /// the statement that counts. Point formats 6 to 10 must have WKT. If no WKT is known, the GeoTIFF keys count, since
  /// only a registry of systems could turn keys into WKT.
  void choose_crs() {
    LasHeader& header = layout_.header;
    if (plan_.replaces_crs && input_ != nullptr && input_->crs_in_evlrs)
      fail_usage("{}: the input states its system in an extended VLR, which cannot be replaced; write PLY, then LAS.",
                 plan_.path.string());
    const bool keeps_own = input_ != nullptr && !plan_.replaces_crs;
    const Crs own = keeps_own && input_->crs ? *input_->crs : Crs();
    const bool has_own = !own.wkt.empty() || !own.geotiff.empty();
    if (plan_.crs && !has_own) added_crs_ = *plan_.crs;
    if (plan_.crs && has_own && !descriptions_.keeps_records && header.point_format >= 6 && own.wkt.empty())
      added_crs_.wkt = plan_.crs->wkt;
    const bool is_old = plan_.layout.las_version.value_or(4) < 4;
    const bool has_keys = !own.geotiff.empty() || !added_crs_.geotiff.empty();
    if (is_old && plan_.crs && !has_keys && kind_of_epsg(plan_.crs->epsg) != CrsKind::unknown)
      added_crs_.geotiff = geotiff_of_epsg(plan_.crs->epsg, plan_.crs->vertical_epsg);  // WKT needs LAS 1.4
    const bool wkt = !own.wkt.empty() || !added_crs_.wkt.empty();
    const bool geotiff = !own.geotiff.empty() || !added_crs_.geotiff.empty();
    if (is_old && wkt && !geotiff)
      layout_.warnings.push_back(fmt::format(
          "{}: LAS 1.{} names a coordinate reference system by GeoTIFF keys, and that of the input is known "
          "only as WKT, so most programs will not find it; state LAS 1.4, or the system with --crs EPSG:CODE.",
          plan_.path.string(), header.minor));
    if (descriptions_.keeps_records && added_crs_.wkt.empty() && added_crs_.geotiff.empty() && !plan_.replaces_crs)
      return;
    const bool modern = header.point_format >= 6;
    const bool wkt_counts = is_old                    ? false
                            : modern                  ? wkt || !geotiff
                            : !added_crs_.wkt.empty() ? !geotiff
                                                      : keeps_own && says_wkt();
    if (wkt_counts) upgrade_las_header(header, 4);
    header.global_encoding =
        static_cast<std::uint16_t>((header.global_encoding & ~kLasWktBit) | (wkt_counts ? kLasWktBit : 0));
    if (modern && geotiff && !wkt)
      layout_.warnings.push_back(fmt::format(
          "{}: point format {} asks for the coordinate reference system as WKT, but {}, and the header says so.",
          plan_.path.string(), header.point_format,
          own.geotiff.empty() && (input_ == nullptr || plan_.replaces_crs)
              ? "only GeoTIFF keys are known; these are written"
              : "the inputs have only GeoTIFF keys; these are kept"));
  }

  bool says_wkt() const { return (layout_.header.global_encoding & kLasWktBit) != 0; }

  /// Warns that waveforms are lost. Waveforms lie after the points or in another file; only the waveforms of the first
  /// input can be kept.
  void warn_of_waveforms() {
    if (!las_has_waveforms(layout_.header.point_format)) return;
    for (const auto& extras : plan_.other_extras) {
      const LasExtras* other = extras_as<LasExtras>(extras);
      if (other == nullptr || !las_has_waveforms(other->point_format)) continue;
      layout_.warnings.push_back(
          fmt::format("{}: waveforms of {} are not copied: only those of the first input are; its references to them "
                      "have no target.",
                      plan_.path.string(), other->file->path().string()));
      return;
    }
  }

  /// Warns that bytes without a description are lost, since bytes of unknown types cannot be converted.
  void warn_of_unnamed_bytes() {
    std::vector<std::shared_ptr<const FormatExtras>> inputs = plan_.other_extras;
    inputs.insert(inputs.begin(), plan_.extras);
    for (const auto& extras : inputs) {
      const LasExtras* las = extras_as<LasExtras>(extras);
      if (las == nullptr || las->unnamed_bytes == 0) continue;
      layout_.warnings.push_back(
          fmt::format("{}: {} bytes of each point of {} that nothing describes are left out, since the inputs differ.",
                      plan_.path.string(), las->unnamed_bytes, las->file->path().string()));
      return;
    }
  }

  /// Sets the pieces of the input. Returns the number of VLRs of the input that no piece contains.
  std::uint32_t place_input() {
    const LasVlrChain& vlrs = input_->vlrs;
    layout_.after = {vlrs.end, input_->header.offset_to_points};
    place_tail();
    std::vector<LasVlr> left_out;
    for (const std::optional<LasVlr>& vlr : {vlrs.laszip, vlrs.copc})
      if (vlr) left_out.push_back(*vlr);
    const bool stale = vlrs.extra_bytes && (descriptions_.extended || !descriptions_.keeps_records);
    if (plan_.replaces_crs) left_out.insert(left_out.end(), vlrs.projection.begin(), vlrs.projection.end());
    layout_.before = pieces_without(left_out, {vlrs.start, stale ? vlrs.extra_bytes->start : vlrs.end});
    if (stale) layout_.between = pieces_without(left_out, {vlrs.extra_bytes->end(), vlrs.end});
    return static_cast<std::uint32_t>(left_out.size()) + (stale ? 1 : 0);
  }

  /// Sets the tail: all bytes after the points of the input except its COPC hierarchy. If the output has a hierarchy,
  /// only extended VLRs are kept.
  void place_tail() {
    const LasVlrChain& evlrs = input_->evlrs;
    LasPiece tail{input_->points_end, input_->file->size()};
    if (points_ == LasPoints::nodes) tail = {evlrs.start, evlrs.end};
    layout_.tail = {tail};
    if (!evlrs.copc_hierarchy) return;
    layout_.tail = pieces_without({*evlrs.copc_hierarchy}, tail);
    if (--layout_.header.evlr_count == 0) layout_.header.evlr_start = 0;
  }

  /// Sets the header entries for the extended VLR with the COPC hierarchy, which follows the extended VLRs of the
  /// input.
  void add_hierarchy() {
    LasHeader& header = layout_.header;
    const LasVlrChain none, &evlrs = input_ != nullptr ? input_->evlrs : none;
    header.evlr_start = layout_.points_end(plan_.count);
    header.evlr_count = evlrs.count - (evlrs.copc_hierarchy ? 1 : 0) + 1;
  }

  static std::vector<LasPiece> pieces_without(std::vector<LasVlr> left_out, LasPiece all) {
    std::ranges::sort(left_out, {}, &LasVlr::start);
    std::vector<LasPiece> pieces;
    for (const LasVlr& vlr : left_out) {
      if (vlr.start < all.begin || vlr.start >= all.end) continue;
      pieces.push_back({all.begin, vlr.start});
      all.begin = vlr.end();
    }
    pieces.push_back(all);
    return pieces;
  }

  static std::uint64_t size_of_all(const std::vector<LasPiece>& pieces) {
    std::uint64_t bytes = 0;
    for (const LasPiece& piece : pieces) bytes += piece.size();
    return bytes;
  }

  /// Changes a byte offset that refers to a place after the points of the input to the same place of the output.
  void move_reference(std::uint64_t& place) const {
    if (place < input_->points_end) return;
    const std::optional<LasVlr>& left_out = input_->evlrs.copc_hierarchy;
    if (left_out && place >= left_out->end()) place -= left_out->end() - left_out->start;
    place = place - input_->points_end + layout_.points_end(plan_.count);
  }

  void add_laszip_vlr() {
    const LasHeader& header = layout_.header;
    const auto extra_bytes = static_cast<std::uint16_t>(header.record_length - *las_record_length(header.point_format));
    const std::uint32_t chunk = points_ == LasPoints::nodes ? LazLayout::kVariable : kLazChunkPoints;
    layout_.laz = LazLayout::for_format(header.point_format, extra_bytes, chunk, plan_.path.string());
    append(layout_.added_vlrs, las_vlr(kLaszipUser, kLaszipRecord, "https://laszip.org", layout_.laz->vlr()));
  }

  void add_extra_bytes_vlr() {
    std::vector<std::byte> vlr =
        las_vlr(kLasSpecUser, kExtraBytesRecord, "Extra bytes", descriptions_.extra_bytes.bytes());
    if (input_ != nullptr && input_->vlrs.extra_bytes) {  // the new VLR keeps the header of the input's VLR
      input_->file->read_at(input_->vlrs.extra_bytes->start, std::span(vlr).first(kLasVlrHeader));
      const auto length = static_cast<std::uint16_t>(descriptions_.extra_bytes.bytes().size());
      std::memcpy(vlr.data() + 20, &length, sizeof length);
    }
    append(layout_.added_vlrs, vlr);
  }

  /// Adds VLRs that state the coordinate reference system in addition to the VLRs of the input. Returns their number.
  std::uint32_t add_crs_vlrs() {
    const LasCrsVlrs vlrs = las_crs_vlrs(added_crs_);
    append(layout_.added_vlrs, vlrs.bytes);
    if (!added_crs_.wkt.empty() && added_crs_.wkt.size() >= kLongestVlr)
      layout_.warnings.push_back(fmt::format(
          "{}: the WKT of the coordinate reference system has {} bytes, more than a VLR can hold; it is left "
          "out.",
          plan_.path.string(), added_crs_.wkt.size()));
    return vlrs.count;
  }

  /// Adds VLRs for the lines of provenance that the input does not have; returns the number of VLRs.
  std::uint32_t add_provenance_vlrs() {
    const std::span<const std::string> all = plan_.provenance;
    std::uint32_t count = 0;
    std::string text;
    const auto flush = [&] {
      if (text.empty()) return;
      append(layout_.provenance_vlrs,
             las_vlr(kProvenanceUser, kProvenanceRecord, "how this file was made", std::as_bytes(std::span(text))));
      text.clear();
      ++count;
    };
    for (const std::string& line : input_ == nullptr ? all : provenance_beyond(all, input_->provenance)) {
      if (text.size() + line.size() + 1 > kLongestVlr) flush();
      text += line + "\n";
    }
    flush();
    return count;
  }

  static void append(std::vector<std::byte>& to, const std::vector<std::byte>& vlrs) {
    to.insert(to.end(), vlrs.begin(), vlrs.end());
  }

  const OutputPlan& plan_;
  const LasPoints points_;
  const LasParts* const input_;
  const LasDescriptions& descriptions_;
  LasLayout& layout_;
  Crs added_crs_;  ///< system that new VLRs state in addition to the VLRs of the input
};

}  // namespace

void place_las_pieces(const OutputPlan& plan, LasPoints points, const LasParts* input,
                      const LasDescriptions& descriptions, LasLayout& layout) {
  PiecePlacer(plan, points, input, descriptions, layout).place();
}

}  // namespace pointsweep
