// SPDX-License-Identifier: MIT
/// The values, other than 0, that the points of an input get in fields that only other inputs have.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// Points without return numbers are return 1 of 1, as LAS wants it. Points of LAS point formats 0 to 5 say in class 12
/// that they lie in the overlap of flight lines; beside inputs of formats 6 to 10 they get the flag of these, too, and
/// keep their class.
class MissingFields {
 public:
  MissingFields() = default;
  /// `common`: the schema that the records of `input` are converted to.
  MissingFields(const FileInfo& input, const Schema& common);

  bool is_needed() const { return !ones_.empty() || overlap_.has_value(); }
  /// Records of the common schema, just converted.
  void run(std::span<std::byte> records, std::size_t stride) const;

 private:
  std::vector<Field> ones_;
  std::optional<std::pair<Field, Field>> overlap_;  ///< classification, overlap
};

}  // namespace pointsweep
