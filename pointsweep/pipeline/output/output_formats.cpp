// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/output_formats.h"

#include <algorithm>

#include "pointsweep/fail.h"
#include "pointsweep/formats/registry.h"

namespace pointsweep {

std::vector<OutputFormat> output_formats(const Outputs& outputs) {
  std::vector<std::filesystem::path> paths = outputs.tiles;
  if (!outputs.points.empty()) paths.push_back(outputs.points);
  std::vector<OutputFormat> formats;
  for (const std::filesystem::path& path : paths) {
    require_output_name(path);
    const Format* const format = format_of_output(path);
    if (format != nullptr && std::ranges::find(formats, format, &OutputFormat::format) == formats.end())
      formats.push_back({format, path});
  }
  return formats;
}

OutputNames names_in_outputs(const InputCloud& cloud, const ChainPlan& plan, const Outputs& outputs,
                             const EngineOptions& options) {
  const std::string name = cloud.readers().empty() ? "The input" : cloud.readers().front()->info().path.string();
  std::vector<std::filesystem::path> examples;
  for (const OutputFormat& format : output_formats(outputs)) examples.push_back(format.example);
  if (examples.empty()) examples.push_back(outputs.points);
  OutputNames names;
  for (const std::filesystem::path& example : examples)
    names = name_outputs(cloud.schema(), name, plan.made, plan.kept, example, {options.prefix, options.replace});
  return names;
}

void require_outputs(const Outputs& outputs) {
  if (outputs.points.empty() && outputs.arrays.empty() && outputs.tiles.empty() && !outputs.writer)
    fail_usage("the run has no output: name a point file, arrays, a writer or tiles.");
}

void require_tiles_possible(const Outputs& outputs, const EngineOptions& options) {
  if (outputs.tiles.empty()) return;
  if (!outputs.points.empty() || !outputs.arrays.empty() || outputs.writer)
    fail_usage("An output for each input cannot be combined with an output of all points; make two runs.");
  if (options.order == Order::sweep)
    fail_usage(
        "A folder of outputs has the points of each input in their order: leave out --order sweep, or name one output "
        "file.");
}

OutputNeeds needs_of(const Outputs& outputs, const EngineOptions& options) {
  const std::vector<OutputFormat> written = output_formats(outputs);
  const bool bounds = std::ranges::any_of(written, [](const OutputFormat& o) { return o.format->needs_bounds; });
  return {.stream_order = options.order == Order::sweep, .bounds = bounds};
}

std::string name_of_output(const Outputs& outputs) {
  if (!outputs.tiles.empty()) return outputs.tiles.front().parent_path().string();
  return outputs.points.empty() ? "the output" : outputs.points.string();
}

}  // namespace pointsweep
