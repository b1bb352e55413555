// SPDX-License-Identifier: MIT
/// Inputs whose decoding costs much more than reading their records (LAZ, E57) are decoded once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

/// Decodes inputs once, since a run reads its input two or three times. During its lifetime, the cloud reads the
/// records of each input with FileInfo::decode_once from one temporary file, with `schema.stride` bytes for each point.
/// The constructor fills that file on all threads.
class DecodedInput {
 public:
  /// `place`: place of the temporary file. Throws Error if an input cannot be decoded or the disk is full; of several
  /// such inputs, the error names the first. Reports the phase "decoding".
  DecodedInput(InputCloud& cloud, const EngineOptions& options, const SpillPlace& place);
  ~DecodedInput();
  DecodedInput(const DecodedInput&) = delete;
  DecodedInput& operator=(const DecodedInput&) = delete;

  /// Returns the bytes of the temporary file.
  std::uint64_t bytes() const { return file_.end(); }

 private:
  void exchange();

  InputCloud& cloud_;
  SpillFile file_;
  /// number of each input, and its own reader, which the cloud does not use meanwhile
  std::vector<std::pair<std::size_t, std::unique_ptr<Reader>>> readers_;
};

/// Returns the bytes that the temporary file of a run over `cloud` will take.
std::uint64_t decoded_input_bytes(const InputCloud& cloud);
/// Returns the line of a dry run that states these bytes; empty for 0 bytes.
std::string decoded_input_text(std::uint64_t bytes);

}  // namespace pointsweep
