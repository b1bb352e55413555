// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_vlrs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <utility>

#include "pointsweep/formats/las/laz_codec.h"

namespace pointsweep {
namespace {

/// Reads small pieces of a file in ascending order with few system calls.
class Window {
 public:
  explicit Window(const InputFile& file) : file_(file) {}

  /// Returns `size` bytes at `offset`. The caller has checked that the file has them.
  const std::byte* at(std::uint64_t offset, std::size_t size) {
    if (offset < first_ || offset + size > first_ + held_) {
      first_ = offset;
      held_ = static_cast<std::size_t>(std::min<std::uint64_t>(bytes_.size(), file_.size() - offset));
      file_.read_at(offset, std::span(bytes_).first(held_));
    }
    return bytes_.data() + (offset - first_);
  }

 private:
  const InputFile& file_;
  std::array<std::byte, 16384> bytes_;
  std::uint64_t first_ = 0;
  std::size_t held_ = 0;
};

constexpr std::size_t kMostProvenance = 256;

/// Returns the member of `chain` that keeps the first record of this user and number; null for other records. note()
/// also collects records of provenance and projection in lists.
std::optional<LasVlr>* place_of(LasVlrChain& chain, std::string_view user, std::uint16_t record) {
  if (user == kLasSpecUser && record == kExtraBytesRecord) return &chain.extra_bytes;
  if (user == kLaszipUser && record == kLaszipRecord) return &chain.laszip;
  if (user == kCopcUser && record == kCopcRecord) return &chain.copc;
  if (user == kCopcUser && record == kCopcHierarchyRecord) return &chain.copc_hierarchy;
  if (user != kLasProjectionUser) return nullptr;
  if (record == kWktRecord) return &chain.wkt;
  if (record == kGeoKeysRecord) return &chain.geo_keys;
  if (record == kGeoDoublesRecord) return &chain.geo_doubles;
  return record == kGeoAsciiRecord ? &chain.geo_ascii : nullptr;
}

/// Stores the place of a record in `chain` if the record is of a kind that readers use.
void note(LasVlrChain& chain, const std::byte* header, const LasVlr& vlr) {
  char user[16];
  std::uint16_t record;
  std::memcpy(user, header + 2, sizeof user);
  std::memcpy(&record, header + 18, sizeof record);
  const std::string_view name(user, std::find(user, user + 16, '\0'));
  const bool tells = name == kProvenanceUser && record == kProvenanceRecord;
  if (tells && chain.provenance.size() < kMostProvenance) chain.provenance.push_back(vlr);
  const bool states_crs = name == kLasProjectionUser && chain.projection.size() < kMostProvenance;
  if (states_crs) chain.projection.push_back(vlr);
  std::optional<LasVlr>* const place = place_of(chain, name, record);
  if (place != nullptr && !*place) *place = vlr;
}

/// Returns the number of bytes after the record's header, a number of 16 bits in a VLR and 64 bits in an EVLR.
std::uint64_t content_length(const std::byte* header, LasVlrKind kind) {
  std::uint64_t length = 0;
  std::memcpy(&length, header + 20, kind == LasVlrKind::vlr ? 2 : 8);
  return length;
}

constexpr std::uint64_t kLongestText = 1 << 20;

/// Returns the content of a record as a container of whole elements; empty if the record is missing or too long.
template <class Content>
Content content_of(const InputFile& file, const std::optional<LasVlr>& vlr) {
  Content content;
  if (!vlr || vlr->length > kLongestText) return content;
  constexpr std::size_t kSize = sizeof(typename Content::value_type);
  content.resize(static_cast<std::size_t>(vlr->length) / kSize);
  file.read_at(vlr->content, std::as_writable_bytes(std::span(content)));
  return content;
}

template <class Content>
void append_vlr(LasCrsVlrs& all, std::uint16_t record, std::string_view description, const Content& content) {
  const auto bytes = std::as_bytes(std::span(content));
  if (bytes.empty() || bytes.size() > kLongestVlr) return;
  const std::vector<std::byte> vlr = las_vlr(kLasProjectionUser, record, description, bytes);
  all.bytes.insert(all.bytes.end(), vlr.begin(), vlr.end());
  ++all.count;
}

/// Returns a VLR or an extended VLR, which differ in the type of the length.
template <class Length>
std::vector<std::byte> record_of(Length length, std::string_view user, std::uint16_t record,
                                 std::string_view description, std::span<const std::byte> content) {
  constexpr std::size_t kLengthAt = 20, kDescriptionAt = kLengthAt + sizeof length, kContentAt = kDescriptionAt + 32;
  std::vector<std::byte> bytes(kContentAt + content.size());
  std::memcpy(bytes.data() + 2, user.data(), std::min<std::size_t>(user.size(), 16));
  std::memcpy(bytes.data() + 18, &record, sizeof record);
  std::memcpy(bytes.data() + kLengthAt, &length, sizeof length);
  std::memcpy(bytes.data() + kDescriptionAt, description.data(), std::min<std::size_t>(description.size(), 32));
  std::copy(content.begin(), content.end(), bytes.begin() + kContentAt);
  return bytes;
}

}  // namespace

LasVlrChain walk_las_vlrs(const InputFile& file, LasVlrKind kind, std::uint64_t start, std::uint64_t limit,
                          std::uint32_t promised, std::vector<std::string>& warnings) {
  const std::uint64_t header_bytes = kind == LasVlrKind::vlr ? kLasVlrHeader : kLasEvlrHeader;
  limit = std::min(limit, file.size());
  Window window(file);
  LasVlrChain chain;
  chain.start = chain.end = start;
  while (chain.count < promised && chain.end <= limit && limit - chain.end >= header_bytes) {
    const std::byte* header = window.at(chain.end, static_cast<std::size_t>(header_bytes));
    const LasVlr vlr{chain.end, chain.end + header_bytes, content_length(header, kind)};
    if (vlr.length > limit - vlr.content) break;
    note(chain, header, vlr);
    chain.end = vlr.end();
    ++chain.count;
  }
  if (chain.count < promised) {
    warnings.push_back(
        fmt::format("the header promises {} {}VLRs, but only {} fit {}; the bytes after them are kept as "
                    "they are.",
                    promised, kind == LasVlrKind::vlr ? "" : "extended ", chain.count,
                    kind == LasVlrKind::vlr ? "before the points" : "into the file"));
  }
  return chain;
}

std::optional<Crs> read_las_crs(const InputFile& file, const LasHeader& header, const LasVlrChain& vlrs,
                                const LasVlrChain& evlrs) {
  const auto either = [](const std::optional<LasVlr>& a, const std::optional<LasVlr>& b) { return a ? a : b; };
  const std::string wkt = content_of<std::string>(file, either(vlrs.wkt, evlrs.wkt));
  GeoTiffKeys keys;
  keys.directory = content_of<std::vector<std::uint16_t>>(file, either(vlrs.geo_keys, evlrs.geo_keys));
  keys.doubles = content_of<std::vector<double>>(file, either(vlrs.geo_doubles, evlrs.geo_doubles));
  keys.ascii = content_of<std::string>(file, either(vlrs.geo_ascii, evlrs.geo_ascii));
  return crs_of_both(wkt, std::move(keys), (header.global_encoding & kLasWktBit) != 0 || header.point_format >= 6);
}

std::vector<std::byte> las_vlr(std::string_view user, std::uint16_t record, std::string_view description,
                               std::span<const std::byte> content) {
  assert(content.size() <= kLongestVlr && "the length of a VLR has 16 bits");
  return record_of(static_cast<std::uint16_t>(content.size()), user, record, description, content);
}

std::vector<std::byte> las_evlr(std::string_view user, std::uint16_t record, std::string_view description,
                                std::span<const std::byte> content) {
  return record_of(std::uint64_t{content.size()}, user, record, description, content);
}

LasCrsVlrs las_crs_vlrs(const Crs& crs) {
  LasCrsVlrs all;
  if (!crs.wkt.empty()) {
    const std::string text = crs.wkt + '\0';
    append_vlr(all, kWktRecord, "OGC WKT coordinate system", text);
  }
  if (!crs.geotiff.empty()) {
    append_vlr(all, kGeoKeysRecord, "GeoTIFF GeoKeyDirectoryTag", crs.geotiff.directory);
    append_vlr(all, kGeoDoublesRecord, "GeoTIFF GeoDoubleParamsTag", crs.geotiff.doubles);
    append_vlr(all, kGeoAsciiRecord, "GeoTIFF GeoAsciiParamsTag", crs.geotiff.ascii);
  }
  return all;
}

}  // namespace pointsweep
