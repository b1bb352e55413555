// SPDX-License-Identifier: MIT
/// Inputs whose decoding costs much more than reading their records (LAZ, E57) are decoded once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

/// A run reads its input two or three times, after what FiniteInput reads. While this object lives, the cloud reads the
/// records of each input with FileInfo::decode_once from a temporary file, `schema.stride` bytes for each point, that
/// the constructor has filled with all threads.
class DecodedInput {
 public:
  /// `place` says where the temporary file of an input goes. Throws Error where an input cannot be decoded or the place
  /// has no space. Reports the phase "decoding".
  DecodedInput(InputCloud& cloud, const EngineOptions& options,
               const std::function<SpillPlace(std::size_t input)>& place);
  ~DecodedInput();
  DecodedInput(const DecodedInput&) = delete;
  DecodedInput& operator=(const DecodedInput&) = delete;

  /// Bytes of the temporary files.
  std::uint64_t bytes() const { return bytes_; }

 private:
  void put_back();

  InputCloud& cloud_;
  std::vector<std::pair<std::size_t, std::unique_ptr<Reader>>> originals_;  ///< by number of the input
  std::uint64_t bytes_ = 0;
};

/// Returns the bytes that the temporary files of a run over `cloud` will take.
std::uint64_t decoded_input_bytes(const InputCloud& cloud);
/// Returns the line of a dry run that states these bytes; empty for 0 bytes.
std::string decoded_input_text(std::uint64_t bytes);

}  // namespace pointsweep
