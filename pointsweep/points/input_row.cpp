// SPDX-License-Identifier: MIT
#include "pointsweep/points/input_row.h"

#include <algorithm>

namespace pointsweep {

bool has_input_row(const Schema& schema) {
  return std::ranges::find(schema.fields, kInputRow, &Field::name) != schema.fields.end();
}

Schema with_input_row(Schema schema) {
  if (!has_input_row(schema)) schema.append(kInputRow, Type::u64);
  return schema;
}

Schema without_input_row(Schema schema) {
  const auto row = std::ranges::find(schema.fields, kInputRow, &Field::name);
  if (row == schema.fields.end()) return schema;
  const auto bytes = static_cast<std::uint32_t>(size_of(row->type));
  if (row->offset + bytes == schema.stride) schema.stride -= bytes;
  schema.fields.erase(row);
  return schema;
}

}  // namespace pointsweep
