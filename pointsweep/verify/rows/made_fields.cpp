// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/made_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

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

namespace {

/// Returns whether the value is an overlap flag that the LAS writer has set because the input has class 12. Old point
/// formats have no such flag.
bool is_overlap_by_class(const Field& field, const Schema& schema, const std::byte* record) {
  const auto classification = schema.find("classification");
  return field.name == "overlap" && classification && value_of(schema.fields[*classification], record) == 12;
}

}  // namespace

std::vector<std::string> unfilled_fields(RowSource& out, const std::vector<std::string>& names, OwnField own_field) {
  std::vector<std::pair<Field, double>> own;
  for (const Field& field : out.schema().fields)
    if (const auto value = own_field != nullptr ? own_field(field.name) : std::nullopt)
      if (std::ranges::find(names, field.name) != names.end()) own.emplace_back(field, *value);
  for (std::uint64_t first = 0; first < out.count() && !own.empty(); first += out.block_rows()) {
    const std::uint64_t rows = std::min<std::uint64_t>(out.block_rows(), out.count() - first);
    const std::byte* record = out.read(first, rows).data();
    for (std::uint64_t i = 0; i < rows; ++i, record += out.schema().stride)
      std::erase_if(own, [&](const auto& one) {
        return value_of(one.first, record) != one.second && !is_overlap_by_class(one.first, out.schema(), record);
      });
  }
  std::vector<std::string> unfilled;
  for (const auto& [field, value] : own) unfilled.push_back(field.name);
  return unfilled;
}

}  // namespace pointsweep
