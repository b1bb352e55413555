// SPDX-License-Identifier: MIT
#include "pointsweep/program/nearest_names.h"

#include <algorithm>
#include <numeric>

#include "pointsweep/points/lower_case.h"

namespace pointsweep {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

std::string nearest_names(std::string_view word, const std::vector<std::string>& known) {
  std::vector<std::string> names = known;
  const auto nearer = [&](const std::string& a, const std::string& b) {
    return edit_distance(word, a) < edit_distance(word, b);
  };
  std::stable_sort(names.begin(), names.end(), nearer);
  names.resize(std::min<std::size_t>(names.size(), 3));
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + ("'" + names[i] + "'");
  return text;
}

std::optional<std::string> probable_name(std::string_view word, const std::vector<std::string>& known) {
  const std::string wanted = in_lower_case(word);
  std::optional<std::string> best;
  std::size_t least = (wanted.size() + 2) / 3 + 1;
  for (const std::string& name : known) {
    const bool begins = wanted.size() >= 3 && in_lower_case(name).starts_with(wanted);
    const std::size_t distance = begins ? 0 : edit_distance(wanted, in_lower_case(name));
    if (distance < least && distance < name.size()) best = name, least = distance;
  }
  return best;
}

}  // namespace pointsweep
