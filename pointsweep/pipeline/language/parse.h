// SPDX-License-Identifier: MIT
/// The syntax of pipelines, without knowledge of operators:
///   knn(k=8) | normals(orient=viewpoint, viewpoint=[0,0,1.7])
/// or as JSON, an array of stages, alone or like in PDAL under the key "pipeline":
///   [{"type": "knn", "k": 8}, {"type": "normals", "orient": "viewpoint", "viewpoint": [0, 0, 1.7]}]
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pointsweep {

/// The text of one option. A list is stored as its elements separated by commas, as "0,0,1.7". The name is empty
/// where only a value is given, as in thin(0.1), which no operator accepts (OptionValues).
struct OptionText {
  std::string name, value;
  std::string place;  ///< for messages, e.g. "pipeline, column 12" or "chain.json, stage 2"

  friend bool operator==(const OptionText& a, const OptionText& b) { return a.name == b.name && a.value == b.value; }
};

struct StageText {
  std::string name;
  std::vector<OptionText> options;
  std::string place;

  friend bool operator==(const StageText& a, const StageText& b) { return a.name == b.name && a.options == b.options; }
};

/// Parses either form: a text that begins with [ or { is JSON. Values with characters other than letters, digits and _
/// . + - % : / need quotes, single or double, with \ before a quote or a \. Throws UsageError with the place; `source`
/// is the name of the text in it.
std::vector<StageText> parse_pipeline(std::string_view text, std::string_view source = "pipeline");

/// Parses JSON only. Accepts pipelines of PDAL whose stages exist here too.
std::vector<StageText> parse_json_pipeline(std::string_view text, std::string_view source);

/// Parses the content of a file if the name ends with .json, otherwise the text itself.
std::vector<StageText> parse_pipeline_or_file(const std::string& text_or_file);

/// Returns the stages as text in the first form; parse_pipeline() restores the stages.
std::string to_text(const std::vector<StageText>& stages);

/// Returns whether `name` may be the name of an operator or an option: letters, digits, _ . and -.
bool is_name(std::string_view name);

}  // namespace pointsweep
