// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/made_fields.h"

#include <fmt/format.h>

#include <algorithm>

#include "pointsweep/formats/field_names.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

Schema schema_of_made(const std::vector<Attribute>& made, const std::string& prefix) {
  Schema schema;
  for (const Attribute& a : made)
    for (const std::string& field : a.fields)
      schema.append(a.name == position_attribute().name ? field : prefix + field, a.type);
  return schema;
}

bool is_field_of(const Schema& schema, const std::string& name) {
  const auto copy = [&](const Field& field) { return name == fmt::format("{}_{}", field.name, name_of(field.type)); };
  const std::vector<std::string> columns = column_names(schema);
  return schema.find(name) || schema.find(library_name_of(name)) ||
         std::find(columns.begin(), columns.end(), name) != columns.end() ||
         std::any_of(schema.fields.begin(), schema.fields.end(), copy);
}

}  // namespace pointsweep
