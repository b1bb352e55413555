// SPDX-License-Identifier: MIT
#include "pointsweep/formats/field_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <ranges>
#include <unordered_set>

#include "pointsweep/fail.h"
#include "pointsweep/points/lower_case.h"

namespace pointsweep {
namespace {

std::string without_separators(std::string name) {
  for (char& c : name) {
    const bool separates = std::string_view(" ,;|\"'").find(c) != std::string_view::npos;
    if (separates || static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '_';
  }
  return name.empty() ? "unnamed" : name;
}

bool is_color(const std::vector<double>& row, std::size_t first) {
  return std::all_of(row.begin() + static_cast<std::ptrdiff_t>(first),
                     row.begin() + static_cast<std::ptrdiff_t>(first + 3),
                     [](double v) { return v >= 0 && v <= 255 && v == std::floor(v); });
}

bool is_normal(const std::vector<double>& row, std::size_t first) {
  const double x = row[first], y = row[first + 1], z = row[first + 2];
  const double length = std::sqrt((x * x + y * y) + z * z);
  return length == 0 || std::abs(length - 1) < 0.01;
}

template <class Predicate>
bool in_all(const std::vector<std::vector<double>>& rows, std::size_t first, Predicate holds) {
  return std::ranges::all_of(rows, [&](const auto& row) { return holds(row, first); });
}

}  // namespace

std::vector<std::string> column_names(const Schema& schema) {
  std::vector<std::string> names;
  std::unordered_set<std::string> given;
  const auto give = [&](const std::string& wish) {
    std::string name = wish;
    for (int n = 2; !given.insert(name).second; ++n) name = fmt::format("{}_{}", wish, n);
    names.push_back(name);
  };
  for (const Field& field : schema.fields) {
    const std::string name = without_separators(field.name);
    if (field.count == 1) give(name);
    for (std::uint32_t c = 0; field.count > 1 && c < field.count; ++c) give(fmt::format("{}_{}", name, c));
  }
  return names;
}

std::string changed_names(const std::filesystem::path& path, std::string_view format, const Schema& schema,
                          const std::vector<std::string>& stored) {
  constexpr std::size_t kMostNamed = 5;
  std::string text;
  std::size_t column = 0, changed = 0;
  for (const Field& field : schema.fields) {
    const std::string& name = stored[column];
    column += field.count;
    if (field.count != 1 || name == field.name || changed++ >= kMostNamed) continue;
    text +=
        fmt::format("{}'{}' {}as '{}'", text.empty() ? "" : ", ", field.name, text.empty() ? "is written " : "", name);
  }
  if (changed == 0) return {};
  if (changed > kMostNamed) text += fmt::format(", and {} more so", changed - kMostNamed);
  return fmt::format("{}: {}, since {} restricts names.", path.string(), text, format);
}

bool has_name(const Schema& schema, std::string_view name) {
  const std::string lower = in_lower_case(name);
  return std::ranges::any_of(schema.fields, [&](const Field& field) { return in_lower_case(field.name) == lower; });
}

std::string unused_name(const Schema& schema, const std::string& name) {
  std::string unused = name;
  for (int n = 2; has_name(schema, unused); ++n) unused = fmt::format("{}_{}", name, n);
  return unused;
}

std::vector<std::string> default_column_names(const std::vector<std::vector<double>>& rows) {
  const std::size_t columns = rows.empty() ? 3 : rows[0].size();
  std::vector<std::string> names{"x", "y", "z"};
  const auto add = [&](std::initializer_list<std::string> more) { names.insert(names.end(), more); };
  if (columns == 4) {
    add({"intensity"});
  } else if (columns == 6 && in_all(rows, 3, is_normal)) {
    add({"nx", "ny", "nz"});
  } else if (columns == 6 && in_all(rows, 3, is_color)) {
    add({"red", "green", "blue"});
  } else if (columns == 7 && in_all(rows, 4, is_color)) {
    add({"intensity", "red", "green", "blue"});
  } else if (columns == 9 && in_all(rows, 3, is_color) && in_all(rows, 6, is_normal)) {
    add({"red", "green", "blue", "nx", "ny", "nz"});
  }
  while (names.size() < columns) names.push_back(fmt::format("column_{}", names.size() + 1));
  return names;
}

const Field& named_field(const Schema& schema, const std::string& word, std::string_view option) {
  const auto at = field_meant(schema, word);
  if (!at) {
    const auto names = schema.fields | std::views::transform(&Field::name);
    fail_usage("{}: the points have no attribute '{}'; they have {}.", option, word, fmt::join(names, ", "));
  }
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
