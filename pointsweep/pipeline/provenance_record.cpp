// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/provenance_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>

#include "pointsweep/pipeline/registry.h"

namespace pointsweep {
namespace {

/// "0.50" and "5e-1" as "0.5".
std::string shortest(std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool good = error == std::errc() && end == text.data() + text.size();
  return good ? fmt::format("{}", number == 0 ? 0.0 : number) : std::string(text);
}

std::string canonical_value(const OptionDeclaration& option, const std::string& value) {
  if (option.kind == OptionKind::choice || option.kind == OptionKind::attribute) return value;
  if (option.kind == OptionKind::whole) {
    const std::size_t first = value.find_first_not_of('0');
    return first == value.npos ? "0" : value.substr(first);
  }
  std::string canonical;
  for (std::size_t begin = 0; begin <= value.size();) {
    const std::size_t end = std::min(value.find(',', begin), value.size());
    canonical += (canonical.empty() ? "" : ",") + shortest(std::string_view(value).substr(begin, end - begin));
    begin = end + 1;
  }
  return canonical;
}

/// `keep_presets`: a value that equals the preset says something, since without it another one holds.
StageText canonical_stage(const StageText& stage, const std::vector<OptionDeclaration>& declared, bool keep_presets) {
  StageText out{stage.name, {}, stage.place};
  for (const OptionDeclaration& option : declared) {
    const auto given = std::ranges::find(stage.options, option.name, &OptionText::name);
    if (given == stage.options.end()) continue;
    const std::string value = canonical_value(option, given->value);
    if (keep_presets || option.preset.empty() || value != canonical_value(option, option.preset))
      out.options.push_back({option.name, value, given->place});
  }
  return out;
}

/// knn without options is knn(k=8); with a radius alone, k=8 is another neighbourhood.
StageText canonical_neighborhood(StageText stage) {
  std::vector<OptionDeclaration> declared = neighborhood_declaration().options;
  const std::string k = declared.front().preset;
  for (OptionDeclaration& option : declared)
    if (option.name == "k") option.preset.clear();
  stage = canonical_stage(stage, declared, false);
  if (stage.options.empty()) stage.options.push_back({"k", k, stage.place});
  return stage;
}

std::string sorted_list(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return fmt::format("{}", fmt::join(names, ","));
}

ProvenanceRecord record_of(const Cloud& cloud, const std::vector<std::string>& keep, const RunOptions& options,
                           int axis, bool drops_nonfinite) {
  ProvenanceRecord record{.version = POINTSWEEP_VERSION, .stages = options.stages, .settings = {}, .inputs = {}};
  const auto set = [&](const char* name, const std::string& value) {
    if (!value.empty()) record.settings.emplace_back(name, value);
  };
  const bool sorted = options.stages == std::vector<std::string>{"sort"};
  set("keep", sorted_list(keep));
  set("order", options.order == Order::sweep ? "sweep" : "");
  set("axis", sorted || options.order == Order::sweep ? std::string(1, "xyz"[axis]) : "");
  set("engine", options.engine == Engine::reference ? "reference" : "");
  set("replace", sorted_list(options.replace));
  set("prefix", options.prefix);
  set("positions", options.moved_positions == Type::f64 ? "" : std::string(name_of(options.moved_positions)));
  set("nonfinite", drops_nonfinite ? "drop" : "");
  for (std::size_t i = 0; i < cloud.readers().size(); ++i) {
    if (!cloud.states()[i].is_known()) continue;
    const FileInfo& info = cloud.readers()[i]->info();
    const auto name =
        options.input_paths ? std::filesystem::absolute(info.path).lexically_normal() : info.path.filename();
    record.inputs.push_back({name.string(), info.count + info.left_out, info.bytes});
  }
  return record;
}

}  // namespace

std::vector<std::string> canonical_stages(const std::vector<StageText>& stages) {
  const NeighborhoodDeclaration& knn = neighborhood_declaration();
  std::vector<std::string> texts;
  const auto add = [&](const StageText& stage) { texts.push_back(to_text(std::vector<StageText>{stage})); };
  if (stages.empty() || stages.front().name != knn.name) add(canonical_neighborhood({knn.name, {}, ""}));
  for (const StageText& stage : stages) {
    if (stage.name == knn.name)
      add(canonical_neighborhood(stage));
    else
      add(canonical_stage(stage, find_operator(stage).options, stage.name == "reneighbor"));
  }
  return texts;
}

std::vector<std::string> provenance_of(const Cloud& cloud, const std::vector<std::string>& keep,
                                       const RunOptions& options, int axis, bool drops_nonfinite) {
  std::vector<std::string> lines;
  for (const auto& reader : cloud.readers()) add_provenance(lines, reader->info().provenance);
  if (options.stages.empty()) return lines;
  // Not by add_provenance(): what the run itself says is never left out, nor is a record that an input has already.
  const std::vector<std::string> own = lines_of(record_of(cloud, keep, options, axis, drops_nonfinite));
  lines.insert(lines.end(), own.begin(), own.end());
  return lines;
}

}  // namespace pointsweep
