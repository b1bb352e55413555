// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <string>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/las/copc_layout.h"
#include "pointsweep/formats/las/las_extra_bytes.h"
#include "pointsweep/formats/las/las_point_formats.h"
#include "pointsweep/formats/las/laz_codec.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/formats/records/record_readers.h"

namespace pointsweep {
namespace {

LasHeader read_header(const InputFile& file, const std::string& path, std::vector<std::string>& warnings) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(std::min<std::uint64_t>(standard_header_size(4), file.size())));
  file.read_at(0, bytes);
  LasHeader header = parse_las_header(bytes, file.size(), path, warnings);
  header.bytes.resize(header.header_size);
  file.read_at(0, header.bytes);
  return header;
}

/// Returns the chain of EVLRs after the points; empty if the header states an impossible place.
LasVlrChain walk_evlrs(const LasParts& parts, std::vector<std::string>& warnings) {
  const LasHeader& header = parts.header;
  if (header.minor < 4 || header.evlr_count == 0) return {};
  if (header.evlr_start < parts.points_end || header.evlr_start > parts.file->size()) {
    warnings.push_back(
        fmt::format("the extended VLRs cannot begin at byte {}: they were not read, but are kept.", header.evlr_start));
    return {};
  }
  return walk_las_vlrs(*parts.file, LasVlrKind::evlr, header.evlr_start, parts.file->size(), header.evlr_count,
                       warnings);
}

void read_extra_bytes(LasParts& parts, const LasVlr& vlr, std::vector<std::string>& warnings) {
  std::optional<std::string> reason;
  if (vlr.length > kMaxExtraBytes * kExtraBytesDescriptor) {
    reason = fmt::format("its {} bytes are more than a VLR can hold", vlr.length);
  } else {
    parts.extra_bytes.resize(static_cast<std::size_t>(vlr.length));
    parts.file->read_at(vlr.content, parts.extra_bytes);
    reason = append_extra_bytes(parts.extra_bytes, parts.header.record_length, parts.schema);
  }
  if (!reason) return;
  parts.extra_bytes.clear();
  warnings.push_back(fmt::format("the extra-bytes VLR at byte {} was ignored: {}.", vlr.start, *reason));
}

void read_provenance(LasParts& parts, const LasVlr& vlr) {
  std::string text(static_cast<std::size_t>(vlr.length), '\0');
  parts.file->read_at(vlr.content, std::as_writable_bytes(std::span(text)));
  std::ranges::move(provenance_in(text), std::back_inserter(parts.provenance));
}

/// Returns the byte after the points. Since the header does not state the end of compressed points, all bytes before
/// the extended VLRs count as points.
std::uint64_t end_of_points(const LasHeader& header, std::uint64_t file_size) {
  if (!header.is_compressed) return header.offset_to_points + point_count(header) * header.record_length;
  const bool has_evlrs = header.minor >= 4 && header.evlr_count != 0 && header.evlr_start >= header.offset_to_points;
  return has_evlrs ? std::min(header.evlr_start, file_size) : file_size;
}

void warn_of_bytes_behind(const LasParts& parts, std::vector<std::string>& warnings) {
  const std::uint64_t behind = parts.file->size() - parts.points_end;
  const LasHeader& header = parts.header;
  const bool explained = header.evlr_count != 0 || header.waveform_start != 0 || point_count(header) == 0;
  if (behind != 0 && !explained) {
    warnings.push_back(fmt::format("{} bytes of unknown meaning follow the last point; they are kept.", behind));
  }
}

std::shared_ptr<LasParts> read_parts(const std::shared_ptr<const InputFile>& file, std::vector<std::string>& warnings) {
  auto parts = std::make_shared<LasParts>();
  parts->file = file;
  parts->header = read_header(*file, file->path().string(), warnings);
  const LasHeader& header = parts->header;
  parts->schema = las_point_schema(header.point_format, header.scale, header.offset);
  parts->points_end = end_of_points(header, parts->file->size());
  parts->vlrs = walk_las_vlrs(*parts->file, LasVlrKind::vlr, header.header_size, header.offset_to_points,
                              header.vlr_count, warnings);
  parts->evlrs = walk_evlrs(*parts, warnings);
  const LasVlrChain& evlrs = parts->evlrs;
  parts->crs = read_las_crs(*parts->file, header, parts->vlrs, evlrs);
  parts->crs_in_evlrs = !evlrs.projection.empty();
  const std::optional<LasVlr> vlr = parts->vlrs.extra_bytes ? parts->vlrs.extra_bytes : evlrs.extra_bytes;
  if (vlr) read_extra_bytes(*parts, *vlr, warnings);
  for (const LasVlr& record : parts->vlrs.provenance) read_provenance(*parts, record);
  parts->schema.stride = header.record_length;
  warn_of_bytes_behind(*parts, warnings);
  return parts;
}

LasOrigin origin_of(const LasHeader& header) {
  // Before LAS 1.2 the time bit was reserved, and times were seconds of the GPS week.
  return {.grid = {header.scale, header.offset},
          .has_time = las_has_time(header.point_format),
          .standard_time = header.minor >= 2 && (header.global_encoding & kLasStandardTimeBit) != 0,
          .overlap_is_class_12 = header.point_format < kFirstModernLasFormat};
}

HeaderClaims claims_of(const LasHeader& header) {
  HeaderClaims claims{.bounds = header.bounds};
  if (header.minor >= 4)
    claims.returns.assign(header.by_return.begin(), header.by_return.end());
  else
    claims.returns.assign(header.legacy_by_return.begin(), header.legacy_by_return.end());
  return claims;
}

std::shared_ptr<const LasExtras> extras_of(const LasParts& parts) {
  auto extras = std::make_shared<LasExtras>();
  extras->file = parts.file;
  extras->minor = parts.header.minor;
  extras->point_format = parts.header.point_format;
  std::uint32_t named = *las_record_length(parts.header.point_format);
  for (const Field& field : parts.schema.fields)
    named = std::max(named, field.offset + static_cast<std::uint32_t>(size_of(field.type)) * field.count);
  extras->unnamed_bytes = parts.schema.stride - std::min(named, parts.schema.stride);
  extras->extra_bytes = parts.extra_bytes;
  return extras;
}

FileInfo info_of(const LasParts& parts, const std::vector<std::string>& warnings) {
  const LasHeader& header = parts.header;
  FileInfo info;
  info.path = parts.file->path();
  info.format =
      fmt::format("{} 1.{} point format {}", header.is_compressed ? "LAZ" : "LAS", header.minor, header.point_format);
  info.schema = parts.schema;
  info.count = point_count(header);
  info.bytes = parts.file->size();
  const Box& box = header.bounds;
  if (info.count != 0 && is_finite(box.lo) && is_finite(box.hi) && box.lo.x <= box.hi.x && box.lo.y <= box.hi.y &&
      box.lo.z <= box.hi.z) {
    info.bounds = box;
  }
  info.claims = claims_of(header);
  info.z_is_up = true;
  for (const std::string& warning : warnings)
    info.warnings.push_back(fmt::format("{}: {}", info.path.string(), warning));
  info.extras = extras_of(parts);
  info.crs = parts.crs;
  info.las = std::make_shared<const LasOrigin>(origin_of(header));
  info.provenance = parts.provenance;
  return info;
}

class LasReader final : public ColumnsReader {
 public:
  LasReader(const LasParts& parts, const std::vector<std::string>& warnings) {
    info_ = info_of(parts, warnings);
    has_records(parts.file, parts.header.offset_to_points);
  }
};

LazPoints open_compressed(const LasParts& parts) {
  const std::string path = parts.file->path().string();
  const LasHeader& header = parts.header;
  if (!parts.vlrs.laszip)
    fail("{}: says that it is compressed (byte 104), but has no LASzip VLR; copy or export it again.", path);
  std::vector<std::byte> vlr(static_cast<std::size_t>(std::min<std::uint64_t>(parts.vlrs.laszip->length, 1u << 16)));
  parts.file->read_at(parts.vlrs.laszip->content, vlr);
  return {parts.file, vlr, header.offset_to_points, point_count(header), header.record_length};
}

/// Returns the nodes of a COPC file; empty for other files. Warns of a hierarchy that cannot be used.
CopcChunks copc_nodes(const LasParts& parts, const LazPoints& points, std::vector<std::string>& warnings) {
  const std::optional<LasVlr>& info = parts.vlrs.copc;
  if (!info || info->length != kCopcInfoBytes) return {};
  std::string why_not;
  CopcChunks nodes = read_copc_nodes(*parts.file, info->content, points, why_not);
  if (!why_not.empty()) warnings.push_back(fmt::format("the hierarchy of the COPC file was ignored: {}.", why_not));
  return nodes;
}

/// Reads compressed points. Chunks for parallel reading are the chunks of the file.
class LazReader final : public Reader {
 public:
  LazReader(const LasParts& parts, std::vector<std::string> warnings)
      : points_(open_compressed(parts)), nodes_(copc_nodes(parts, points_, warnings)) {
    info_ = info_of(parts, warnings);
    // The memory of buffers, layers and models, estimated from the peak memory of runs.
    constexpr std::uint64_t kDecoderBytes = 3 << 20;
    info_.decoder_bytes = kDecoderBytes;
    info_.decode_once = true;
    if (nodes_.depths.empty() || !std::isfinite(nodes_.spacing) || !(nodes_.spacing > 0)) return;
    info_.root_spacing = nodes_.spacing;
    info_.format += fmt::format(" with {} levels of detail (COPC)", std::ranges::max(nodes_.depths) + 1);
  }

  bool has_decoders() const override { return true; }
  Chunk chunk_of(std::uint64_t row) const override {
    const std::size_t chunk = points_.chunk_of(row);
    const std::uint64_t first = points_.first_row(chunk);
    return {first,
            points_.first_row(chunk + 1) - first,
            points_.first_byte(chunk),
            points_.first_byte(chunk + 1),
            nodes_.boxes.empty() ? std::nullopt : std::optional(nodes_.boxes[chunk]),
            nodes_.depths.empty() ? std::nullopt : std::optional(nodes_.depths[chunk])};
  }
  std::unique_ptr<RowDecoder> decoder(const WantedFields&) const override { return std::make_unique<Decoder>(*this); }

 private:
  class Decoder final : public RowDecoder {
   public:
    explicit Decoder(const LazReader& reader) : reader_(reader), cursor_(reader.points_) {}

    std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
      const std::size_t rows = reader_.rows_for(row, records);
      cursor_.read(row, records.first(rows * reader_.info_.schema.stride));
      return rows;
    }

   private:
    const LazReader& reader_;
    LazPoints::Cursor cursor_;
  };

  LazPoints points_;
  CopcChunks nodes_;
};

}  // namespace

bool LasExtras::is_like(const FormatExtras& other) const {
  const auto& las = static_cast<const LasExtras&>(other);
  return minor == las.minor && point_format == las.point_format && unnamed_bytes == las.unnamed_bytes &&
         extra_bytes == las.extra_bytes;
}

std::shared_ptr<const LasParts> LasExtras::parts() const {
  std::vector<std::string> ignored;  // the reader has reported these warnings
  return read_parts(file, ignored);
}

std::unique_ptr<Reader> open_las(const std::filesystem::path& path) {
  std::vector<std::string> warnings;
  const std::shared_ptr<const LasParts> parts = read_parts(std::make_shared<const InputFile>(path), warnings);
  if (parts->header.is_compressed) return std::make_unique<LazReader>(*parts, std::move(warnings));
  return std::make_unique<LasReader>(*parts, warnings);
}

}  // namespace pointsweep
