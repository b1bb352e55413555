// SPDX-License-Identifier: MIT
/// The chain of (extended) variable length records of a LAS file: its end, the places of the records that readers use,
/// the coordinate reference system that VLRs of the user LASF_Projection state, and the bytes of new records.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/las/las_header.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

inline constexpr std::uint64_t kLasVlrHeader = 54, kLasEvlrHeader = 60;
inline constexpr std::string_view kLasSpecUser = "LASF_Spec";
inline constexpr std::uint16_t kExtraBytesRecord = 4;
inline constexpr std::string_view kLasProjectionUser = "LASF_Projection";
inline constexpr std::uint16_t kWktRecord = 2112, kGeoKeysRecord = 34735, kGeoDoublesRecord = 34736,
                               kGeoAsciiRecord = 34737;
/// User and record number of the VLR with the info of a COPC file, and record number of the extended VLR with its
/// nodes.
inline constexpr std::string_view kCopcUser = "copc";
inline constexpr std::uint16_t kCopcRecord = 1, kCopcHierarchyRecord = 1000;
/// User and record number of the VLRs with the provenance of the file (formats/provenance.h): lines, each ended by a
/// line feed.
inline constexpr std::string_view kProvenanceUser = "pointsweep";
inline constexpr std::uint16_t kProvenanceRecord = 1;

/// A record of the chain, as byte offsets in the file.
struct LasVlr {
  std::uint64_t start = 0;    ///< first byte of its header
  std::uint64_t content = 0;  ///< first byte of its content, after the header
  std::uint64_t length = 0;   ///< bytes of its content
  std::uint64_t end() const { return content + length; }
};

/// The result of walk_las_vlrs(). The contents of records are not kept: there may be many records, and a writer
/// copies them from the file.
struct LasVlrChain {
  std::uint64_t start = 0, end = 0;                             ///< bytes of the complete records
  std::uint32_t count = 0;                                      ///< number of complete records
  std::optional<LasVlr> extra_bytes;                            ///< the first record of extra bytes
  std::optional<LasVlr> laszip, copc, copc_hierarchy;           ///< the first record of each kind
  std::optional<LasVlr> wkt, geo_keys, geo_doubles, geo_ascii;  ///< the first record of each kind; see read_las_crs()
  std::vector<LasVlr> provenance;                               ///< the first 256 records of pointsweep
  std::vector<LasVlr> projection;                               ///< the first 256 records of LASF_Projection
};

enum class LasVlrKind { vlr, evlr };

/// Walks up to `promised` records from byte `start` on. A record that extends past `limit` ends the chain with a
/// warning: its bytes and all later bytes have an unknown meaning.
LasVlrChain walk_las_vlrs(const InputFile& file, LasVlrKind kind, std::uint64_t start, std::uint64_t limit,
                          std::uint32_t promised, std::vector<std::string>& warnings);

/// Returns the system that the VLRs and the extended VLRs state; none if they state no system. A record of each kind is
/// taken from the VLRs, or from the extended VLRs if the VLRs have none of this kind. If there are both WKT and GeoTIFF
/// keys, the WKT is valid if the header sets the WKT bit or the point format is 6 or higher, else the keys; the other
/// statement is kept too. Records over 1 MiB are not read.
std::optional<Crs> read_las_crs(const InputFile& file, const LasHeader& header, const LasVlrChain& vlrs,
                                const LasVlrChain& evlrs);

/// Returns a VLR: its header of 54 bytes and `content`, at most 65,535 bytes.
std::vector<std::byte> las_vlr(std::string_view user, std::uint16_t record, std::string_view description,
                               std::span<const std::byte> content);
/// Returns an extended VLR: its header of 60 bytes and `content`.
std::vector<std::byte> las_evlr(std::string_view user, std::uint16_t record, std::string_view description,
                                std::span<const std::byte> content);

/// Largest number of bytes in the content of a VLR.
inline constexpr std::size_t kLongestVlr = 65535;

/// VLRs that state a system by its WKT, its GeoTIFF keys, or both: their bytes, one after another, and their number.
struct LasCrsVlrs {
  std::vector<std::byte> bytes;
  std::uint32_t count = 0;
};
/// Returns the VLRs for `crs`. A VLR whose content is longer than kLongestVlr is left out.
LasCrsVlrs las_crs_vlrs(const Crs& crs);

}  // namespace pointsweep
