// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "pointsweep/formats/registry.h"

namespace pointsweep {
namespace {

std::string row_of(const Format& format) {
  std::string extensions;
  for (const std::string_view extension : format.extensions)
    extensions += fmt::format("{}{}", extensions.empty() ? "" : " ", extension);
  const bool points = format.content == Format::Content::points;
  const auto answer = [&](bool yes) { return points ? (yes ? "yes" : "no") : ""; };
  if (!extensions.empty()) extensions = fmt::format("`{}`", extensions);
  return fmt::format("| {}{} | {} | {} | {} | {} | {} | {} |\n", format.title,
                     format.details.empty() ? "" : fmt::format(" ([details]({}))", format.details), format.reads,
                     format.writes, extensions, answer(format.holds_crs), answer(format.holds_provenance),
                     points ? (format.real_coordinates ? "float64, NaN" : "integers on a grid") : "");
}

}  // namespace

std::string formats_table() {
  std::string table =
      "| format | read | write | extensions | CRS | how it was made | coordinates |\n|---|---|---|---|---|---|---|\n";
  for (const Format* format : formats()) table += row_of(*format);
  return table;
}

}  // namespace pointsweep
