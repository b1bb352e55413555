// SPDX-License-Identifier: MIT
#include "pointsweep/formats/field_names.h"

#include <fmt/format.h>

#include <string_view>
#include <unordered_set>

namespace pointsweep {
namespace {

std::string without_separators(std::string name) {
  for (char& c : name) {
    const bool separates = std::string_view(" ,;\"'").find(c) != std::string_view::npos;
    if (separates || static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '_';
  }
  return name.empty() ? "unnamed" : name;
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

}  // namespace pointsweep
