// SPDX-License-Identifier: MIT
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "pointsweep/fail.h"
#include "pointsweep/pipeline/language/pdal_stages.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

using Json = nlohmann::ordered_json;  // keeps options in the order of the text

/// Parses JSON. Throws UsageError for repeated keys, of which nlohmann::json would silently use the last.
Json parsed(std::string_view text, std::string_view source) {
  std::vector<std::set<std::string>> keys;
  const auto refuse_twice = [&](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
      fail_usage("{}: '{}' is given twice in one stage.", source, value.get<std::string>());
    return true;
  };
  try {
    return Json::parse(text, refuse_twice);
  } catch (const Json::parse_error& error) {
    const std::size_t at = std::min(error.byte == 0 ? 0 : error.byte - 1, text.size());
    const std::string_view before = text.substr(0, at);
    const std::size_t line_start = before.rfind('\n') + 1;  // 0 where there is no line before
    fail_usage("{}, line {}, column {}: is not JSON; an array of stages looks like [{{\"type\": \"normals\"}}].",
               source, std::count(before.begin(), before.end(), '\n') + 1, at - line_start + 1);
  } catch (const Json::exception&) {
    fail_usage("{}: holds a number that no double can hold.", source);
  }
}

/// Returns a number, word or truth value as text without quotes; nullopt for other values.
std::optional<std::string> scalar_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
  if (value.is_number_unsigned()) return fmt::format("{}", value.get<std::uint64_t>());
  if (value.is_number_integer()) return fmt::format("{}", value.get<std::int64_t>());
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return std::nullopt;
}

std::string value_of_option(const Json& value, const std::string& name, const std::string& place) {
  const auto text_of = [&](const Json& v) {
    const auto text = scalar_text(v);
    if (!text) fail_usage("{}: '{}' is not a number, a word or a list of these.", place, name);
    return *text;
  };
  if (!value.is_array()) return text_of(value);
  std::string list;
  for (const Json& element : value) list += (list.empty() ? "" : ",") + text_of(element);
  return list;
}

StageText stage_of(const Json& json, const std::string& place) {
  if (!json.is_object())
    fail_usage("{}: is not an object such as {{\"type\": \"normals\"}}; files are named on the command line.", place);
  const auto type = json.find("type");
  if (type == json.end() || !type->is_string() || !is_name(type->get<std::string>()))
    fail_usage("{}: has no \"type\", which names the operator, e.g. \"normals\".", place);
  StageText stage{type->get<std::string>(), {}, place};
  for (const auto& [name, value] : json.items()) {
    if (name == "type") continue;
    if (!is_name(name)) fail_usage("{}: '{}' is not the name of an option.", place, name);
    stage.options.push_back({name, value_of_option(value, name, place), place});
  }
  return stage;
}

bool is_of_pdal(const Json& stage) {
  return stage.is_object() && stage.contains("type") && stage["type"].is_string() &&
         is_pdal_stage(stage["type"].get<std::string>());
}

/// Returns whether the stage is a reader or writer of PDAL, given only by its file.
bool names_file(const Json& stage) {
  return stage.is_string() || (stage.is_object() && !stage.contains("type") && stage.contains("filename"));
}

}  // namespace

std::vector<StageText> parse_json_pipeline(std::string_view text, std::string_view source) {
  Json json = parsed(text, source);
  if (json.is_object()) {
    if (json.size() != 1 || !json.contains("pipeline"))
      fail_usage("{}: is an object without \"pipeline\" as its only key; give an array of stages.", source);
    json = Json(std::move(json["pipeline"]));
  }
  if (!json.is_array() || json.empty())
    fail_usage("{}: is not an array of stages such as [{{\"type\": \"normals\"}}].", source);
  const bool is_pdal = std::ranges::any_of(json, is_of_pdal);
  std::vector<StageText> stages;
  std::size_t number = 0;
  for (const Json& stage : json) {
    ++number;
    if (is_pdal && names_file(stage)) continue;
    stages.push_back(stage_of(stage, fmt::format("{}, stage {}", source, number)));
  }
  return is_pdal ? stages_of_pdal(stages) : stages;
}

}  // namespace pointsweep
