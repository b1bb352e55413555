// SPDX-License-Identifier: MIT
/// One schema for inputs that differ.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pointsweep/formats/common_grid.h"
#include "pointsweep/formats/missing_fields.h"
#include "pointsweep/formats/value_range.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// How the records of one input become those of the cloud: shifted, then converted, then completed.
struct InputMapping {
  GridShift shift;
  std::unique_ptr<RecordConversion> conversion;  ///< null where the layout is the same
  MissingFields missing = {};
};

struct CommonSchema {
  Schema schema;
  std::vector<InputMapping> mappings;  ///< one for each input
  std::vector<ValueRange> ranges;      ///< of the values of each field, as far as the types of the inputs tell
  /// One sentence for each input that lacks fields of another one, at most five.
  std::vector<std::string> warnings;
};

/// As class InputCloud documents it. Names that mean the same (`nx`, `NormalX`) are one field, under the first one's
/// name.
CommonSchema common_schema(const std::vector<std::unique_ptr<Reader>>& readers);

}  // namespace pointsweep
