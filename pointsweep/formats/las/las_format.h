// SPDX-License-Identifier: MIT
/// Writers of LAS, LAZ and COPC. Outputs keep the parts of a LAS input for which they have a place; other inputs become
/// LAS 1.4 unless the user states another version (see las_layout.h). The functions las_values() and copc_values()
/// collect facts about all values of a cloud before the first point is stored.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/known_values.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Collects the facts about all points that the layout of the output needs. Reads the cloud once if the types of its
/// fields do not decide which point format holds them, or if real coordinates may lie on the grid of their LAS file or
/// on a grid of decimal fractions, as in text files. `progress` gets the number of points read; it may throw.
KnownValues las_values(InputCloud& cloud, const FileLayout& layout, const std::function<void(std::uint64_t)>& progress);

/// Returns whether las_values() reads the cloud.
bool las_values_need_points(const InputCloud& cloud, const FileLayout& layout);

/// Returns the rounding of coordinates to the grid of the output; none if the output stores them unchanged.
StoredCoordinate las_stored_coordinate(const OutputPlan& plan);

/// Creates a writer. Throws Error, before anything is written, if the points cannot be stored as LAS. Without a LAS
/// input, plan.bounds is required unless the coordinates are integers that 32 signed bits hold, a grid is stated, or
/// there are no points.
std::unique_ptr<Writer> create_las_writer(const OutputPlan& plan);

/// Creates a writer like create_las_writer(), which writes the points in compressed chunks and takes records only in
/// order. All threads compress several chunks of kLazChunkPoints points at once. Throws Error if codecs are not built
/// in.
std::unique_ptr<Writer> create_laz_writer(const OutputPlan& plan);

/// Creates a writer of COPC, that is, LAZ with levels of detail. It keeps all points in memory or in files of
/// OutputPlan::scratch, and writes them after the last one has come (levels/level_choice.h).
std::unique_ptr<Writer> create_copc_writer(const OutputPlan& plan);
StoredCoordinate copc_stored_coordinate(const OutputPlan& plan);
KnownValues copc_values(InputCloud& cloud, const FileLayout& layout,
                        const std::function<void(std::uint64_t)>& progress);
bool copc_values_need_points(const InputCloud& cloud, const FileLayout& layout);
/// Returns the least OutputPlan::encoder_bytes of the writer of COPC.
std::uint64_t copc_encoder_bytes(std::uint64_t record_bytes, unsigned threads);
/// Computes Format::aside_bytes of COPC.
std::uint64_t copc_aside_bytes(std::uint64_t count, std::uint64_t record_bytes, std::uint64_t memory, unsigned threads);

/// Returns the least memory of the writer of LAZ for records of `record_bytes`: the chunks that are compressed at once,
/// before and after compression, and the models of the coder.
std::uint64_t laz_encoder_bytes(std::uint64_t record_bytes, unsigned threads);

}  // namespace pointsweep
