// SPDX-License-Identifier: MIT
#include "pointsweep/formats/named_field.h"

#include <fmt/ranges.h>

#include "pointsweep/fail.h"
#include "pointsweep/formats/field_names.h"

namespace pointsweep {

const Field& named_field(const Schema& schema, const std::string& word, std::string_view option) {
  const auto at = field_meant(schema, word);
  if (!at)
    fail_usage("{}: the points have no attribute '{}'; they have {}.", option, word,
               fmt::join(column_names(schema), ", "));
  return schema.fields[*at];
}

std::vector<std::size_t> named_fields(const Schema& schema, const std::vector<std::string>& words,
                                      std::string_view option) {
  std::vector<std::size_t> fields;
  for (const std::string& word : words)
    fields.push_back(static_cast<std::size_t>(&named_field(schema, word, option) - schema.fields.data()));
  return fields;
}

}  // namespace pointsweep
