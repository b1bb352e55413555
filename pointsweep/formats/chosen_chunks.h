// SPDX-License-Identifier: MIT
/// A reader of only some chunks of a file, and the choice of chunks by levels of detail (depths in a COPC octree).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "pointsweep/reader.h"

namespace pointsweep {

/// The chosen chunks of a file, as if the file had no others.
class ChosenChunks final : public Reader {
 public:
  using Choice = std::function<bool(const Chunk&)>;
  /// `all` must have decoders. Bytes of chunks that are not chosen are not read. If `word` is not empty, it becomes
  /// FileInfo::asked_for_as. FileInfo then has no bounds and no claims, since the header states both for all points of
  /// the file.
  ChosenChunks(std::shared_ptr<Reader> all, const Choice& is_chosen, std::string_view word = "");

  Chunk chunk_of(std::uint64_t row) const override;
  bool has_decoders() const override { return true; }
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted) const override;
  void rest() override;
  /// Returns the row in the file of the chosen row `row`.
  std::uint64_t input_row(std::uint64_t row) const;

 private:
  class Decoder;
  struct Chosen {
    std::uint64_t first_row;  ///< first row of the chunk, counted among the chosen rows
    Chunk chunk;              ///< the chunk of the file
  };
  const Chosen& chosen_at(std::uint64_t row) const;

  std::shared_ptr<Reader> all_;
  std::vector<Chosen> chosen_;
};

/// Returns the least depth, but at most 31, at which the spacing of points is at most `spacing`. `root`: the spacing at
/// depth 0, which halves with each depth.
int depth_of_spacing(double root, double spacing);

/// Returns whether a word for the format of inputs chooses levels of detail: "depth:3" for nodes of depths 0 to 3, or
/// "spacing:0.5" for nodes of all depths up to the first depth with this spacing or less. Throws UsageError for a word
/// that begins with "depth:" or "spacing:" and is invalid.
bool chooses_levels(std::string_view word);
/// Returns a reader of only the nodes that `word` chooses. Throws Error for a file without levels.
std::unique_ptr<Reader> with_chosen_levels(std::unique_ptr<Reader> all, std::string_view word);

}  // namespace pointsweep
