// SPDX-License-Identifier: MIT
/// Writing E57 (ASTM E2807): one scan without a pose.
#pragma once

#include <cstdint>
#include <memory>

#include "pointsweep/writer.h"

namespace pointsweep {

/// Coordinates in the type of the input, integers of a LAS grid as scaled integers. A point whose coordinates are not
/// all finite is marked as invalid, and reads as NaN. Attributes that the standard names are stored under its names,
/// normals as the extension for surface normals has it, all others as `ps:NAME`. Throws Error where codecs are not
/// built in, and for an unsigned integer above 2^63 - 1.
std::unique_ptr<Writer> create_e57_writer(const OutputPlan& plan);

/// Returns the bytes that encoding takes, for any records.
std::uint64_t e57_encoder_bytes(std::uint64_t record_bytes, unsigned threads);

}  // namespace pointsweep
