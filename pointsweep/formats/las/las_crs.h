// SPDX-License-Identifier: MIT
/// The coordinate reference system of a LAS file: VLRs of the user LASF_Projection.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/formats/las/las_header.h"
#include "pointsweep/formats/las/las_vlrs.h"

namespace pointsweep {

/// Returns the system that the VLRs, or else the extended VLRs, state; none if they state no system. WKT counts where
/// the header says so or there are no GeoTIFF keys; the other statement is kept too. Texts over 1 MiB are not read.
std::optional<Crs> read_las_crs(const InputFile& file, const LasHeader& header, const LasVlrChain& vlrs,
                                const LasVlrChain& evlrs);

/// A VLR: its header of 54 bytes and `content`, at most 65,535 bytes.
std::vector<std::byte> las_vlr(std::string_view user, std::uint16_t record, std::string_view description,
                               std::span<const std::byte> content);

/// Bytes that a VLR can hold.
inline constexpr std::size_t kLongestVlr = 65535;

/// VLRs that state a system as it was read, one after another, and their number: the WKT, the GeoTIFF keys, or both.
struct LasCrsVlrs {
  std::vector<std::byte> bytes;
  std::uint32_t count = 0;
};
LasCrsVlrs las_crs_vlrs(const Crs& crs);

}  // namespace pointsweep
