// SPDX-License-Identifier: MIT
/// Writing LAS and LAZ: a LAS input keeps all it has, anything else becomes LAS 1.4 (see las_layout.h). The properties
/// of all values of a cloud are known before its first point is stored.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/known_values.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Reads the cloud once if the types of its fields leave open which point format holds them, or if real coordinates may
/// lie on the grid of the LAS file that they came from, or of decimal fractions such as text files have. `progress`
/// gets the number of points read; it may throw.
KnownValues las_values(InputCloud& cloud, const FileLayout& layout, const std::function<void(std::uint64_t)>& progress);

/// Returns whether las_values() reads the cloud.
bool las_values_need_points(const InputCloud& cloud, const FileLayout& layout);

/// Returns how coordinates are rounded to the grid of the output.
StoredCoordinate las_stored_coordinate(const OutputPlan& plan);

/// Throws Error before anything is written when the points cannot be stored as LAS. Without a LAS input, plan.bounds
/// has to be there unless the coordinates are integers of at most 32 bits.
std::unique_ptr<Writer> create_las_writer(const OutputPlan& plan);

/// Creates a writer like create_las_writer(), which writes the points in compressed chunks. Records come in order. All
/// threads compress several chunks of kLazChunkPoints points at once. Throws Error where codecs are not built in.
std::unique_ptr<Writer> create_laz_writer(const OutputPlan& plan);

/// Creates a writer of LAZ with levels of detail: a COPC file. It puts all points aside, in OutputPlan::scratch, and
/// writes them when all have come (levels/level_choice.h).
std::unique_ptr<Writer> create_copc_writer(const OutputPlan& plan);
StoredCoordinate copc_stored_coordinate(const OutputPlan& plan);
KnownValues copc_values(InputCloud& cloud, const FileLayout& layout,
                        const std::function<void(std::uint64_t)>& progress);
bool copc_values_need_points(const InputCloud& cloud, const FileLayout& layout);
/// Returns the least OutputPlan::encoder_bytes of that writer.
std::uint64_t copc_encoder_bytes(std::uint64_t record_bytes, unsigned threads);
/// Returns Format::aside_bytes.
std::uint64_t copc_aside_bytes(std::uint64_t count, std::uint64_t record_bytes, std::uint64_t memory,
                               unsigned threads);

/// Returns the bytes that the writer takes for records of `record_bytes`: the chunks that are compressed at once,
/// before and after compression, and the models of the coder.
std::uint64_t laz_encoder_bytes(std::uint64_t record_bytes, unsigned threads);

}  // namespace pointsweep
