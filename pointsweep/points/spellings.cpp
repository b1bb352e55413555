// SPDX-License-Identifier: MIT
/// The names under which programs store an attribute, and the words by which users name it.
#include <algorithm>
#include <array>

#include "pointsweep/points/lower_case.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {
namespace {

/// Spellings of each field: first the library's own name, then other names in the order in which Schema::find() tries
/// them. All are in lower case, since comparisons ignore case. CloudCompare puts `scalar_` before the names of its
/// scalar fields; `diffuse_` comes from older PLY exporters.
using Row = std::array<std::string_view, 9>;
constexpr Row kRows[] = {
    {"nx", "normal_x", "normalx", "normal x", "normal.x"},
    {"ny", "normal_y", "normaly", "normal y", "normal.y"},
    {"nz", "normal_z", "normalz", "normal z", "normal.z"},
    {"red", "r", "diffuse_red", "scalar_red"},
    {"green", "g", "diffuse_green", "scalar_green"},
    {"blue", "b", "diffuse_blue", "scalar_blue"},
    {"alpha", "a", "diffuse_alpha"},
    {"intensity", "scalar_intensity", "i"},
    {"gps_time", "gpstime", "gps time", "scalar_gpstime", "scalar_gps_time"},
    {"return_number", "returnnumber", "return number", "scalar_returnnumber", "scalar_return_number"},
    {"number_of_returns", "numberofreturns", "number of returns", "num_returns", "scalar_numberofreturns",
     "scalar_number_of_returns"},
    {"classification", "class", "scalar_classification"},
    {"scan_angle", "scanangle", "scan angle", "scan_angle_rank", "scananglerank", "scalar_scanangle",
     "scalar_scan_angle", "scalar_scananglerank", "scalar_scan_angle_rank"},
    {"user_data", "userdata", "user data", "scalar_userdata", "scalar_user_data"},
    {"point_source_id", "pointsourceid", "point source id", "scalar_pointsourceid", "scalar_point_source_id"},
    {"curvature", "surface_variation", "scalar_curvature", "scalar_surface_variation"},
    {"surface_variation", "curvature", "scalar_surface_variation", "scalar_curvature"},
};

/// Names of PDAL, laspy and lasR for fields of LAS, each row after the library's own name. Users may write these names
/// in conditions and options. Readers do not rename a column of a file that has one of these names.
constexpr Row kWordsOfUsers[] = {
    {"classification", "raw_classification"},
    {"return_number", "return_num"},
    {"scan_direction_flag", "scandirectionflag"},
    {"edge_of_flight_line", "edgeofflightline"},
    {"synthetic", "synthetic_flag"},
    {"key_point", "keypoint", "keypoint_flag"},
    {"withheld", "withheld_flag"},
    {"overlap", "overlap_flag"},
    {"scanner_channel", "scannerchannel", "scanchannel"},
    {"point_source_id", "pt_src_id"},
    {"nir", "infrared"},
};

/// Returns the library's own name for the field that a user calls `word`; `word` in lower case if it is unknown.
std::string meaning_of(std::string_view word) {
  const std::string name = library_name_of(word);
  for (const Row& row : kWordsOfUsers)
    if (!name.empty() && std::ranges::find(row, name) != row.end()) return std::string(row.front());
  return name;
}

}  // namespace

std::vector<std::string> spellings_of(std::string_view name) {
  for (const Row& row : kRows) {
    if (row.front() != name) continue;
    const auto end = std::find(row.begin(), row.end(), std::string_view{});
    return {row.begin(), end};
  }
  return {std::string(name)};
}

std::vector<std::string> words_for(std::string_view name) {
  std::vector<std::string> words = spellings_of(name);
  for (const Row& row : kWordsOfUsers)
    if (row.front() == name) words.insert(words.end(), row.begin() + 1, std::ranges::find(row, std::string_view{}));
  return words;
}

std::vector<std::string> names_with_spellings() {
  std::vector<std::string> names;
  for (const Row& row : kRows) names.emplace_back(row.front());
  for (const Row& row : kWordsOfUsers)
    if (std::ranges::find(names, row.front()) == names.end()) names.emplace_back(row.front());
  return names;
}

std::string library_name_of(std::string_view spelling) {
  const std::string word = in_lower_case(spelling);
  for (const Row& row : kRows) {
    if (!word.empty() && std::find(row.begin(), row.end(), word) != row.end()) return std::string(row.front());
  }
  return word;
}

bool is_spelling_of(std::string_view field, std::string_view word) {
  const std::vector<std::string> spellings = spellings_of(field);
  return in_lower_case(field) == in_lower_case(word) || library_name_of(field) == meaning_of(word) ||
         std::ranges::find(spellings, in_lower_case(word)) != spellings.end();
}

bool means_only(std::string_view word, std::string_view field) {
  const std::string lower = in_lower_case(word);
  return lower == in_lower_case(field) || (library_name_of(lower) == field && spellings_of(lower).size() == 1);
}

std::optional<std::size_t> field_meant(const Schema& schema, std::string_view word) {
  const auto same = std::ranges::find(schema.fields, word, &Field::name);
  if (same != schema.fields.end()) return static_cast<std::size_t>(same - schema.fields.begin());
  const auto known = schema.find(word);
  if (known) return known;
  const auto named = schema.find(library_name_of(word));
  return named ? named : schema.find(meaning_of(word));
}

}  // namespace pointsweep
