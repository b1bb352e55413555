// SPDX-License-Identifier: MIT
/// Pipelines in JSON: arrays of stages of this library, and pipelines of PDAL, whose stages are translated.
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

using Json = nlohmann::ordered_json;  // keeps options in the order of the text

/// Parses JSON. Throws UsageError for invalid JSON, and for repeated keys, of which nlohmann::json would silently use
/// the last.
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
    const std::size_t line_start = before.rfind('\n') + 1;  // 0 on the first line
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

/// A stage of PDAL. Records for which of its options take() was called.
class PdalStage {
 public:
  explicit PdalStage(const StageText& text) : text_(text) {}
  const std::string& name() const { return text_.name; }
  const std::string& place() const { return text_.place; }
  std::optional<std::string> take(const std::string& option) {
    known_.insert(option);
    const auto found = std::ranges::find(text_.options, option, &OptionText::name);
    return found == text_.options.end() ? std::nullopt : std::optional(found->value);
  }
  std::string take(const std::string& option, const std::string& preset) { return take(option).value_or(preset); }
  std::string required(const std::string& option) {
    const auto value = take(option);
    if (!value) fail_usage("{}: {} needs its option '{}'.", place(), name(), option);
    return *value;
  }
  /// Throws UsageError if the stage has an option that take() was not called for, except `tag`, `inputs` and
  /// `user_data`. `instead`: advice with which the message ends.
  void require_no_more(const std::string& instead) {
    known_.insert({"tag", "inputs", "user_data"});
    for (const OptionText& option : text_.options)
      if (!known_.contains(option.name))
        fail_usage("{}: the option '{}' of {} is not known here; {}.", place(), option.name, name(), instead);
  }

 private:
  const StageText& text_;
  std::set<std::string> known_;
};

/// Converts a range of PDAL to a condition. In `Classification[2:5)`, a bracket includes the limit, a parenthesis
/// excludes it. A limit may be absent; `!` after the name negates the range.
std::string condition_of_range(const std::smatch& range) {
  const std::string name = range[1];
  std::vector<std::string> sides;
  if (range[4].length() > 0) sides.push_back(name + (range[3] == "[" ? " >= " : " > ") + range[4].str());
  if (range[5].length() > 0) sides.push_back(name + (range[6] == "]" ? " <= " : " < ") + range[5].str());
  const std::string both = sides.empty() ? name + " == " + name : fmt::format("{}", fmt::join(sides, " && "));
  return (range[2] == "!" ? "!(" : "(") + both + ")";
}

/// Joins ranges of one dimension by "or", and ranges of different dimensions by "and".
std::string condition_of_limits(const std::string& limits, const std::string& place) {
  static const std::regex range(R"(\s*([A-Za-z_]\w*)(!?)([\[(])\s*([^\s:,]*)\s*:\s*([^\s\])]*)\s*([\])])\s*(,|$))");
  std::vector<std::pair<std::string, std::string>> conditions;  // name, condition
  auto at = limits.cbegin();
  for (std::smatch match; at != limits.cend(); at = match[0].second) {
    if (!std::regex_search(at, limits.cend(), match, range, std::regex_constants::match_continuous))
      fail_usage("{}: the limits '{}' are not ranges such as Classification[2:2].", place, limits);
    const auto same = std::ranges::find(conditions, match[1].str(), [](const auto& c) { return c.first; });
    if (same == conditions.end())
      conditions.emplace_back(match[1], condition_of_range(match));
    else
      same->second += " || " + condition_of_range(match);
  }
  std::string all;
  for (const auto& [name, condition] : conditions) all += (all.empty() ? "(" : " && (") + condition + ")";
  return all;
}

/// Converts `([xmin,xmax],[ymin,ymax])` to `xmin,ymin,xmax,ymax`.
std::string crop_bounds(std::string bounds, const std::string& place) {
  std::erase(bounds, ' ');
  static const std::regex plane(R"(\(\[([^,\]]+),([^,\]]+)\],\[([^,\]]+),([^,\]]+)\]\))");
  std::smatch match;
  if (!std::regex_match(bounds, match, plane))
    fail_usage("{}: the bounds '{}' are not ([xmin,xmax],[ymin,ymax]).", place, bounds);
  return fmt::format("{},{},{},{}", match[1].str(), match[3].str(), match[2].str(), match[4].str());
}

std::string with_commas(const std::string& numbers) {
  std::istringstream words(numbers);
  std::string list;
  for (std::string word; words >> word;) list += (list.empty() ? "" : ",") + word;
  return list;
}

std::string lower_case_where(const std::string& assignment) {
  static const std::regex where(R"(\bwhere\b)", std::regex::icase);
  return std::regex_replace(assignment, where, "where");
}

/// The stages of this library that are equivalent to the stages of PDAL added so far.
class OurStages {
 public:
  void add(const StageText& text) {
    PdalStage stage(text);
    const std::string& name = stage.name();
    if (name.starts_with("readers.") || name.starts_with("writers.")) {
      stage.take("filename");
      stage.require_no_more("give the option of the command, as 'pointsweep help run' lists them");
      return;
    }
    for (const auto& [known, make] : kFilters)
      if (name == known) {
        (this->*make)(stage);
        return stage.require_no_more("leave it out, or write our own stage, as 'pointsweep operators' lists them");
      }
    fail_usage("{}: {} is a stage of PDAL without a counterpart here; 'pointsweep operators' lists what there is.",
               stage.place(), name);
  }

  std::vector<StageText> finish() && {
    if (first_) stages_.insert(stages_.begin(), {"knn", {*first_}, first_->place});
    return std::move(stages_);
  }

 private:
  void nothing(PdalStage&) {}
  void range(PdalStage& s) { ours("where", s, {{"", condition_of_limits(s.required("limits"), s.place())}}); }
  void expression(PdalStage& s) { ours("where", s, {{"", s.required("expression")}}); }
  void assign(PdalStage& s) { ours("set", s, {{"", lower_case_where(s.required("value"))}}); }
  void crop(PdalStage& s) {
    const std::string polygon = s.take("polygon", "");
    if (!polygon.empty() && s.take("bounds"))
      fail_usage("{}: filters.crop has bounds and a polygon; give one of them.", s.place());
    ours("crop", s,
         {polygon.empty() ? std::pair("bounds", crop_bounds(s.required("bounds"), s.place()))
                          : std::pair("polygon", polygon),
          {"outside", s.take("outside", "false")}});
  }
  void head(PdalStage& s) { ours("head", s, {{"number", s.take("count", "10")}}); }
  void transformation(PdalStage& s) { ours("transform", s, {{"matrix", with_commas(s.required("matrix"))}}); }
  void sample(PdalStage& s) { ours("poisson", s, {{"radius", s.required("radius")}}); }
  void voxel_center(PdalStage& s) { ours("voxel", s, {{"size", s.take("cell", "1")}, {"keep", "center"}}); }
  void smrf(PdalStage& s) {
    ours("ground", s,
         {{"cell", s.take("cell", "1")},
          {"slope", s.take("slope", "0.15")},
          {"window", s.take("window", "18")},
          {"threshold", s.take("threshold", "0.5")},
          {"scalar", s.take("scalar", "1.25")}});
  }
  void hag_nn(PdalStage& s) { ours("height", s, {{"k", s.take("count", "1")}}); }
  void normal(PdalStage& s) {
    near(s, "k", s.take("knn", "8"));
    ours("normals", s, {{"orient", s.take("always_up", "true") == "true" ? "up" : "none"}});
  }
  void lof(PdalStage& s) {
    near(s, "k", s.take("minpts", "10"));
    ours("lof", s, {});
  }
  void dbscan(PdalStage& s) {
    const std::string eps = s.take("eps", "1");
    near(s, "radius", eps);
    ours("dbscan", s, {{"eps", eps}, {"min_points", s.take("min_points", "6")}});
  }
  void outlier(PdalStage& s) {
    const std::string noise = s.take("class", "7");
    const bool is_radius = s.take("method", "statistical") == "radius";
    if (is_radius) {
      const std::string radius = s.take("radius", "1");
      near(s, "radius", radius);
      ours("ror", s, {{"radius", radius}, {"min_neighbors", s.take("min_k", "2")}});
    } else {
      near(s, "k", s.take("mean_k", "8"));
      ours("sor", s, {{"multiplier", s.take("multiplier", "2")}, {"definition", "pdal"}});
    }
    ours("set", s, {{"", fmt::format("classification = {} where outlier == 1", noise)}});
    ours("drop", s, {{"", is_radius ? "outlier" : "outlier,mean_distance"}});
  }

  void ours(const std::string& name, const PdalStage& of, std::vector<std::pair<std::string, std::string>> options) {
    StageText stage{name, {}, of.place()};
    for (auto& [option, value] : options) stage.options.push_back({option, value, of.place()});
    stages_.push_back(std::move(stage));
  }

  /// Sets the neighbourhood that a stage needs. In PDAL each stage has its own neighbourhood; in this library a stage
  /// uses the last neighbourhood that the pipeline states before it.
  void near(const PdalStage& of, const std::string& option, const std::string& value) {
    const OptionText wanted{option, value, of.place()};
    if (!first_)
      first_ = wanted;
    else if (latest_.name != option || latest_.value != value)
      stages_.push_back({"reneighbor", {wanted}, of.place()});
    latest_ = wanted;
  }

  using Make = void (OurStages::*)(PdalStage&);
  static constexpr std::array<std::pair<std::string_view, Make>, 17> kFilters = {{
      {"filters.head", &OurStages::head},
      {"filters.range", &OurStages::range},
      {"filters.expression", &OurStages::expression},
      {"filters.assign", &OurStages::assign},
      {"filters.crop", &OurStages::crop},
      {"filters.transformation", &OurStages::transformation},
      {"filters.sample", &OurStages::sample},
      {"filters.voxelcenternearestneighbor", &OurStages::voxel_center},
      {"filters.smrf", &OurStages::smrf},
      {"filters.hag_nn", &OurStages::hag_nn},
      {"filters.normal", &OurStages::normal},
      {"filters.lof", &OurStages::lof},
      {"filters.dbscan", &OurStages::dbscan},
      {"filters.outlier", &OurStages::outlier},
      {"filters.merge", &OurStages::nothing},
      {"filters.info", &OurStages::nothing},
      {"filters.stats", &OurStages::nothing},
  }};

  std::vector<StageText> stages_;
  std::optional<OptionText> first_;
  OptionText latest_;
};

/// Converts stages of PDAL to equivalent stages, in order, with their neighbourhoods. Readers and writers are dropped,
/// since files are named on the command line; so are merge, info and stats. Throws UsageError for a stage, or an option
/// of a stage, without an equivalent.
std::vector<StageText> stages_of_pdal(const std::vector<StageText>& stages) {
  OurStages ours;
  for (const StageText& stage : stages) ours.add(stage);
  return std::move(ours).finish();
}

/// Returns whether the name has the form of PDAL's stages: `readers.las`, `filters.range`, `writers.copc`.
bool is_pdal_stage(std::string_view name) {
  return name.starts_with("readers.") || name.starts_with("filters.") || name.starts_with("writers.");
}

bool is_of_pdal(const Json& stage) {
  return stage.is_object() && stage.contains("type") && stage["type"].is_string() &&
         is_pdal_stage(stage["type"].get<std::string>());
}

/// Returns whether the stage is a reader or writer of PDAL, given by its file without a type.
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
