// SPDX-License-Identifier: MIT
/// Readers of LAS and LAZ 1.0 to 1.4, point formats 0 to 10. Records are the bytes of the LAS file, without conversion.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "pointsweep/formats/las/las_header.h"
#include "pointsweep/formats/las/las_vlrs.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

/// All parts of a LAS file except its points. VLRs, EVLRs and bytes of unknown meaning are not in memory; writers copy
/// them from the file.
struct LasParts {
  std::shared_ptr<const InputFile> file;
  LasHeader header;
  Schema schema;                        ///< schema of the point records
  LasVlrChain vlrs;                     ///< VLRs between header and points
  LasVlrChain evlrs;                    ///< extended VLRs after the points
  std::vector<std::byte> extra_bytes;   ///< descriptors that fit the records; empty if there are none
  std::uint64_t points_end = 0;         ///< byte after the last point, or after all bytes of compressed points
  std::optional<Crs> crs;               ///< system that VLRs or extended VLRs state
  bool crs_in_evlrs = false;            ///< an extended VLR states a system
  std::vector<std::string> provenance;  ///< lines about how the file was made, from its VLRs
};

/// The parts of a LAS input that the writers of LAS, LAZ and COPC use. Most parts are not kept in memory, since a run
/// may have many inputs; parts() reads them from the file.
struct LasExtras final : FormatExtras {
  static constexpr std::string_view kFormat = "las";
  std::string_view format() const override { return kFormat; }
  bool is_like(const FormatExtras& other) const override;

  std::shared_ptr<const LasParts> parts() const;

  std::shared_ptr<const InputFile> file;
  std::uint8_t minor = 4, point_format = 0;  ///< entries of the LasHeader
  std::uint32_t unnamed_bytes = 0;           ///< bytes at the end of a record that nothing describes
  std::vector<std::byte> extra_bytes;        ///< LasParts::extra_bytes
};

/// Opens a LAS or LAZ file. Throws Error if the file is not LAS, is truncated or contradicts itself, or if it is
/// compressed and codecs are not built in.
std::unique_ptr<Reader> open_las(const std::filesystem::path& path);

}  // namespace pointsweep
