// SPDX-License-Identifier: MIT
/// Inputs whose decoding costs much more than reading their records (LAZ, E57) are decoded once.
#pragma once

#include <cstdint>
#include <string>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

/// Returns the cloud in which all inputs with FileInfo::decode_once are read from one temporary file at `place`, with
/// FileInfo::schema.stride bytes for each point. Decoding once saves time, since a run reads its input two or three
/// times. Fills the file on all threads. Throws Error if an input cannot be decoded or the disk is full; of several
/// such inputs, the error names the first. Reports the phase "decoding".
InputCloud decoded_input(const InputCloud& cloud, const EngineOptions& options, const SpillPlace& place);

/// Returns the bytes that the temporary file of a run over `cloud` will take.
std::uint64_t decoded_input_bytes(const InputCloud& cloud);
/// Returns the line of a dry run that states decoded_input_bytes(); empty for 0 bytes.
std::string decoded_input_text(std::uint64_t bytes);

}  // namespace pointsweep
