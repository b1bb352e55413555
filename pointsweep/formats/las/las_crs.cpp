// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_crs.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <string>
#include <utility>

namespace pointsweep {
namespace {

constexpr std::uint64_t kLongestText = 1 << 20;

/// The content of a record as whole elements of T, empty if there is no record.
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

}  // namespace

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
  std::vector<std::byte> vlr(kLasVlrHeader + content.size());
  const auto length = static_cast<std::uint16_t>(content.size());
  std::memcpy(vlr.data() + 2, user.data(), std::min<std::size_t>(user.size(), 16));
  std::memcpy(vlr.data() + 18, &record, sizeof record);
  std::memcpy(vlr.data() + 20, &length, sizeof length);
  std::memcpy(vlr.data() + 22, description.data(), std::min<std::size_t>(description.size(), 32));
  std::copy(content.begin(), content.end(), vlr.begin() + kLasVlrHeader);
  return vlr;
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
