// SPDX-License-Identifier: MIT
/// One schema for inputs that differ.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/common_grid.h"
#include "pointsweep/formats/missing_fields.h"
#include "pointsweep/formats/value_range.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// The steps that turn a record of one input into a record of the cloud: shift, then conversion, then completion.
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

/// Returns the schema that class InputCloud documents. Names with the same meaning (`nx`, `NormalX`) are one field,
/// under the first of these names.
CommonSchema common_schema(const std::vector<std::unique_ptr<Reader>>& readers);

}  // namespace pointsweep
