// SPDX-License-Identifier: MIT
/// Writing LAZ: what a LAS file would be (las_writer.h), with its points in compressed chunks.
#pragma once

#include <cstdint>
#include <memory>

#include "pointsweep/writer.h"

namespace pointsweep {

/// Creates a writer like create_las_writer(). Records come in order. All threads compress several chunks of
/// kLazChunkPoints points at once. Throws Error where codecs are not built in.
std::unique_ptr<Writer> create_laz_writer(const OutputPlan& plan);

/// Returns the bytes that the writer takes for records of `record_bytes`: the chunks that are compressed at once,
/// before and after compression, and the models of the coder.
std::uint64_t laz_encoder_bytes(std::uint64_t record_bytes, unsigned threads);

}  // namespace pointsweep
