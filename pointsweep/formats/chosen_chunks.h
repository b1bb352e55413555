// SPDX-License-Identifier: MIT
/// Some chunks of a file, read as if it had no others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "pointsweep/reader.h"

namespace pointsweep {

class ChosenChunks final : public Reader {
 public:
  using Choice = std::function<bool(const Chunk&)>;
  /// `all` has decoders. Bytes of chunks that are not chosen are not read. `word`: FileInfo::asked_for_as.
  ChosenChunks(std::unique_ptr<Reader> all, const Choice& is_chosen, std::string_view word = "");

  Chunk chunk_of(std::uint64_t row) const override;
  bool has_decoders() const override { return true; }
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted) const override;
  void rest() override;
  /// Returns the row of the file that is row `row`.
  std::uint64_t input_row(std::uint64_t row) const;
  /// Returns the reader of all rows; this one is of no use afterwards.
  std::unique_ptr<Reader> release() { return std::move(all_); }

 private:
  class Decoder;
  struct Chosen {
    std::uint64_t first_row;  ///< among the chosen rows
    Chunk chunk;              ///< of the file
  };
  const Chosen& chosen_at(std::uint64_t row) const;

  std::unique_ptr<Reader> all_;
  std::vector<Chosen> chosen_;
};

/// Returns the least depth at which points lie no farther apart than `spacing`, at most 31. `root`: how far they lie
/// apart at depth 0.
int depth_of_spacing(double root, double spacing);

/// Returns whether a word for the format of inputs chooses levels of detail: "depth:3", all nodes of depths 0 to 3, or
/// "spacing:0.5", all nodes of as many depths as it takes until points lie no farther apart. Throws UsageError for a
/// word that begins so and goes on otherwise.
bool chooses_levels(std::string_view word);
/// Returns a reader of these nodes alone. Throws Error for a file without levels.
std::unique_ptr<Reader> with_chosen_levels(std::unique_ptr<Reader> all, std::string_view word);

}  // namespace pointsweep
