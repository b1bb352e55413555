// SPDX-License-Identifier: MIT
/// Readers of files whose points are lines of text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "pointsweep/formats/files/line_reader.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

/// Converts lines to records. All fields are parsed, even if only some are wanted, so that an invalid value ends a run
/// in its first pass over the file.
class LineParser {
 public:
  virtual ~LineParser() = default;
  /// Parses line number `number` of the file, from 1. Throws Error for a line that is not a record.
  virtual void parse(std::string_view line, std::uint64_t number, std::byte* record) = 0;
};

/// A reader whose chunks are the rows between two places of RowLines.
class RowTextReader : public Reader {
 public:
  Chunk chunk_of(std::uint64_t row) const override;
  bool has_decoders() const override { return true; }
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted = {}) const override;

 protected:
  /// Returns a parser for one thread.
  virtual std::unique_ptr<LineParser> parser() const = 0;

  std::unique_ptr<const InputFile> file_;
  std::optional<RowLines> rows_;

 private:
  class Decoder;
};

}  // namespace pointsweep
