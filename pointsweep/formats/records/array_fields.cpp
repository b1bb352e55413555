// SPDX-License-Identifier: MIT
#include "pointsweep/formats/records/array_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "pointsweep/points/lower_case.h"

namespace pointsweep {
namespace {

bool is_word_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::ranges::find(names, name) != names.end();
}

bool has_field_named(const Schema& schema, const std::string& name) {
  return std::ranges::any_of(schema.fields,
                             [&](const Field& f) { return in_lower_case(f.name) == in_lower_case(name); });
}

/// The names of the components that the library has names for; none for another array.
std::vector<std::string> known_components(const std::string& name, Type type, std::uint32_t components) {
  const std::string lower = in_lower_case(name);
  const bool real = type == Type::f32 || type == Type::f64;
  if (components == 3 && real && is_word_of(lower, {"normal", "normals"})) return {"nx", "ny", "nz"};
  if (components == 3 && is_word_of(lower, {"xyz", "points", "position", "positions", "vertices", "coordinates"}))
    return {"x", "y", "z"};
  if (components != 3 && components != 4) return {};
  if (type != Type::u8 || !is_word_of(lower, {"color", "colors", "colour", "colours", "rgb", "rgba"})) return {};
  std::vector<std::string> names{"red", "green", "blue", "alpha"};
  names.resize(components);
  return names;
}

}  // namespace

std::size_t append_array(Schema& schema, const std::string& name, Type type, std::uint32_t components) {
  const std::size_t first = schema.fields.size();
  const std::vector<std::string> known = known_components(name, type, components);
  if (!known.empty() && std::ranges::none_of(known, [&](const auto& n) { return has_field_named(schema, n); })) {
    for (const std::string& component : known) schema.append(component, type);
    return first;
  }
  std::string free = name;
  for (int i = 2; has_field_named(schema, free); ++i) free = fmt::format("{}_{}", name, i);
  schema.append(free, type, components);
  return first;
}

}  // namespace pointsweep
