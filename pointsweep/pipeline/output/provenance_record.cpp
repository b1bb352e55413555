// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/provenance_record.h"

#include <fmt/format.h>

#include <algorithm>

#include "pointsweep/formats/provenance.h"
#include "pointsweep/pipeline/language/run_words.h"
#include "pointsweep/pipeline/sweep_engine.h"

namespace pointsweep {
namespace {

std::string sorted_list(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return fmt::format("{}", fmt::join(names, ","));
}

ProvenanceRecord record_of(const InputCloud& cloud, const RunRecord& run) {
  const EngineOptions& options = run.options;
  ProvenanceRecord record{.version = POINTSWEEP_VERSION, .stages = run.stages, .settings = {}, .inputs = {}};
  const auto set = [&](const char* name, const std::string& value) {
    if (!value.empty()) record.settings.emplace_back(name, value);
  };
  const auto set_current = [&](const char* name) { set(name, run_words(name).current(options)); };
  const bool sorted = run.stages == std::vector<std::string>{"sort"};
  set("keep", sorted_list(run.keep));
  set_current("order");
  set("axis", sorted || options.order == Order::sweep ? std::string(1, "xyz"[run.axis]) : "");
  const SweepEngine* const engine = engine_of(options.engine);
  set("engine", engine != nullptr ? engine->name() : "");
  set("replace", sorted_list(options.replace));
  set("prefix", options.prefix);
  set_current("positions");
  set("nonfinite", run.drops_nonfinite ? "drop" : "");
  const auto asked_for =
      std::ranges::find_if(cloud.readers(), [](const auto& r) { return !r->info().asked_for_as.empty(); });
  if (asked_for != cloud.readers().end()) set("format", (*asked_for)->info().asked_for_as);
  for (std::size_t i = 0; i < cloud.readers().size(); ++i) {
    if (!cloud.states()[i].is_known()) continue;
    const FileInfo& info = cloud.readers()[i]->info();
    const auto name =
        options.input_paths ? std::filesystem::absolute(info.path).lexically_normal() : info.path.filename();
    record.inputs.push_back({name.string(), info.count + info.left_out, info.bytes});
  }
  return record;
}

/// The records of the inputs, then this one.
std::vector<std::string> lines_with(const InputCloud& cloud, const ProvenanceRecord& record, const RunRecord& run) {
  std::vector<std::string> lines;
  for (const auto& reader : cloud.readers()) add_provenance(lines, reader->info().provenance);
  if (!run.options.provenance) return lines;
  // Not by add_provenance(): what the run itself says is never left out, nor is a record that an input has already.
  const std::vector<std::string> own = lines_of(record);
  lines.insert(lines.end(), own.begin(), own.end());
  return lines;
}

}  // namespace

std::vector<std::string> provenance_of(const InputCloud& cloud, const RunRecord& run) {
  return lines_with(cloud, record_of(cloud, run), run);
}

std::vector<std::string> provenance_of_tile(const InputCloud& input, TileNumber number, const RunRecord& run) {
  ProvenanceRecord record = record_of(input, run);
  record.settings.emplace_back("tile", fmt::format("{} of {}", number.tile + 1, number.tiles));
  record.more_inputs = number.tiles - 1;
  return lines_with(input, record, run);
}

}  // namespace pointsweep
