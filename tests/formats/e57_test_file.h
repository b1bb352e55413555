// SPDX-License-Identifier: MIT
/// E57 files made byte by byte from the standard (ASTM E2807-11), without any code of the library.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace e57_test {

inline constexpr std::size_t kPage = 1024, kPayload = 1020;

/// Returns the CRC-32C (Castagnoli) of the bytes. Pages end with it, the highest byte first.
inline std::uint32_t crc32c(const char* bytes, std::size_t size) {
  std::uint32_t crc = ~std::uint32_t{0};
  for (std::size_t i = 0; i < size; ++i) {
    crc ^= static_cast<std::uint8_t>(bytes[i]);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0x82F63B78u : 0u);
  }
  return ~crc;
}

inline std::uint64_t physical(std::uint64_t logical) { return logical + 4 * (logical / kPayload); }

inline std::string paged(std::string logical) {
  logical.resize((logical.size() + kPayload - 1) / kPayload * kPayload);
  std::string file;
  for (std::size_t at = 0; at < logical.size(); at += kPayload) {
    file += logical.substr(at, kPayload);
    const std::uint32_t crc = crc32c(logical.data() + at, kPayload);
    for (const int shift : {24, 16, 8, 0}) file += static_cast<char>(crc >> shift);
  }
  return file;
}

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
std::string stream_of(const std::vector<T>& values) {
  std::string bytes;
  for (const T value : values) append(bytes, value);
  return bytes;
}

/// Packs integers of `bits` bits each, the lowest bit first.
inline std::string packed(const std::vector<std::uint64_t>& values, int bits) {
  std::string bytes((values.size() * static_cast<std::size_t>(bits) + 7) / 8, '\0');
  for (std::size_t i = 0; i < values.size() * static_cast<std::size_t>(bits); ++i)
    if (values[i / static_cast<std::size_t>(bits)] >> (i % static_cast<std::size_t>(bits)) & 1)
      bytes[i / 8] = static_cast<char>(bytes[i / 8] | (1 << (i % 8)));
  return bytes;
}

struct Attribute {
  std::string name, type;  ///< e.g. cartesianX, Float precision="single"
  std::string stream;
};

inline Attribute reals(const std::string& name, const std::vector<double>& values) {
  return {name, "type=\"Float\"", stream_of(values)};
}
inline Attribute singles(const std::string& name, const std::vector<float>& values) {
  return {name, "type=\"Float\" precision=\"single\"", stream_of(values)};
}
inline Attribute integers(const std::string& name, int least, int most, int bits,
                          const std::vector<std::uint64_t>& above_least, const std::string& scaling = "") {
  return {name,
          std::string("type=\"") + (scaling.empty() ? "Integer" : "ScaledInteger") + "\" minimum=\"" +
              std::to_string(least) + "\" maximum=\"" + std::to_string(most) + "\"" + scaling,
          packed(above_least, bits)};
}

struct Scan {
  std::uint64_t points = 0;
  std::vector<Attribute> attributes;
  std::string pose;  ///< XML
};

inline std::string pose(const std::string& w, const std::string& z, const std::string& x_shift) {
  return "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">" + w +
         "</w><x type=\"Float\">0</x><y type=\"Float\">0</y><z type=\"Float\">" + z +
         "</z></rotation><translation type=\"Structure\"><x type=\"Float\">" + x_shift +
         "</x><y type=\"Float\">0</y><z type=\"Float\">0</z></translation></pose>";
}

/// Returns the compressed vector of a scan, in one data packet. `logical`: logical offset at which the vector begins.
inline std::string compressed_vector(const Scan& scan, std::uint64_t logical) {
  std::string packet;
  for (const Attribute& a : scan.attributes) append(packet, static_cast<std::uint16_t>(a.stream.size()));
  for (const Attribute& a : scan.attributes) packet += a.stream;
  packet.resize((packet.size() + 6 + 3) / 4 * 4 - 6);
  std::string bytes(8, '\0');
  bytes[0] = 1;
  append(bytes, std::uint64_t{32 + 6 + packet.size()});
  append(bytes, physical(logical + 32));
  append(bytes, std::uint64_t{0});
  bytes += '\1';
  bytes += '\0';
  append(bytes, static_cast<std::uint16_t>(packet.size() + 6 - 1));
  append(bytes, static_cast<std::uint16_t>(scan.attributes.size()));
  return bytes + packet;
}

/// Returns a file. `images`: elements of the list of images.
inline std::string file(const std::vector<Scan>& scans, const std::string& coordinate_system = "",
                        const std::string& images = "") {
  std::string body, data3d;
  for (const Scan& scan : scans) {
    const std::uint64_t at = 48 + body.size();
    data3d += "<vectorChild type=\"Structure\"><guid type=\"String\">{s}</guid>" + scan.pose +
              "<points type=\"CompressedVector\" fileOffset=\"" + std::to_string(physical(at)) + "\" recordCount=\"" +
              std::to_string(scan.points) + "\"><prototype type=\"Structure\">";
    for (const Attribute& a : scan.attributes) data3d += "<" + a.name + " " + a.type + "/>";
    data3d += "</prototype><codecs type=\"Vector\" allowHeterogeneousChildren=\"1\"/></points></vectorChild>";
    body += compressed_vector(scan, at);
  }
  const std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?><e57Root type=\"Structure\" "
      "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" "
      "xmlns:nor=\"http://www.libe57.org/E57_NOR_surface_normals.txt\">"
      "<formatName type=\"String\">ASTM E57 3D Imaging Data File</formatName><guid type=\"String\">{f}</guid>"
      "<versionMajor type=\"Integer\">1</versionMajor><versionMinor type=\"Integer\">0</versionMinor>"
      "<coordinateMetadata type=\"String\">" +
      coordinate_system + "</coordinateMetadata><data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">" + data3d +
      "</data3D><images2D type=\"Vector\" allowHeterogeneousChildren=\"1\">" + images + "</images2D></e57Root>";
  const std::uint64_t logical = 48 + body.size() + xml.size();
  std::string header = "ASTM-E57";
  append(header, std::uint32_t{1});
  append(header, std::uint32_t{0});
  append(header, std::uint64_t{(logical + kPayload - 1) / kPayload * kPage});
  append(header, physical(48 + body.size()));
  append(header, std::uint64_t{xml.size()});
  append(header, std::uint64_t{kPage});
  return paged(header + body + xml);
}

}  // namespace e57_test
