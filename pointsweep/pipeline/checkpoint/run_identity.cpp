// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/checkpoint/run_identity.h"

#include <fmt/format.h>

#include <sstream>

#include "pointsweep/fail.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/program/run_options.h"
#include "pointsweep/storage/local/place.h"

namespace pointsweep {
namespace {

/// Version of checkpoints. Must be increased with every change of their content or of the cutting into slabs and cells.
constexpr int kCheckpointFormat = 9;

std::string inputs_text(const InputCloud& cloud) {
  std::string text;
  for (std::size_t i = 0; i < cloud.readers().size(); ++i) {
    const FileInfo& info = cloud.readers()[i]->info();
    const FileState& state = cloud.states()[i];
    if (!state.is_known())
      fail("Only files can be gone on with, and '{}' is none: leave out --resume.", info.path.string());
    text += fmt::format("input '{}' with {} points, {}{}\n", whole_name(info.path), info.count, state.text(),
                        info.asked_for_as.empty() ? "" : ", read as " + info.asked_for_as);
  }
  return text;
}

std::string outputs_text(const Outputs& outputs) {
  std::string text;
  if (!outputs.points.empty()) text += fmt::format("output '{}'\n", whole_name(outputs.points));
  for (const auto& tile : outputs.tiles) text += fmt::format("output '{}' of an input\n", whole_name(tile));
  for (const auto& [name, path] : outputs.arrays) text += fmt::format("output '{}' of {}\n", whole_name(path), name);
  return text;
}

std::string kept_text(const KeptFields& kept, const Schema& input) {
  std::string text;
  if (kept.input) text += "of the input keeping";
  for (const std::size_t f : kept.input.value_or(std::vector<std::size_t>())) text += " " + input.fields[f].name;
  if (!kept.left_out.empty()) text += ", of what is made leaving out";
  for (const std::string& field : kept.left_out) text += " " + field;
  if (!kept.order.empty()) text += fmt::format(", named {}", fmt::join(kept.order, " "));
  return text.empty() ? "" : text + "\n";
}

std::string pass_text(const PlannedPass& pass) {
  const SweepPlan& plan = pass.plan;
  std::string text = "pass of";
  for (const Stage& stage : plan.stages) text += " " + name_of(stage.op);
  text += ", making";
  for (const Attribute& a : pass.made) text += " " + a.name;
  return text + "\n";
}

}  // namespace

std::string run_identity(const InputCloud& cloud, const ChainPlan& plan, const Outputs& outputs,
                         const EngineOptions& options) {
  std::string text = fmt::format("version {}, checkpoints {}\n", POINTSWEEP_VERSION, kCheckpointFormat);
  text += inputs_text(cloud) + outputs_text(outputs);
  text += fmt::format("cells of {} points\n{}", options.cell_points, identity_text(options));
  if (const std::optional<StatedCrs>& stated = cloud.stated_crs())
    text += fmt::format("crs {} {}\n", stated->crs ? short_text(*stated->crs) : "none",
                        stated->crs ? stated->crs->wkt : "");
  text += fmt::format("pipeline {}\n", fmt::join(canonical_stages(plan, Presets::spelled_out), " | "));
  for (const PlannedPass& pass : plan.passes) text += pass_text(pass);
  text += kept_text(plan.kept, cloud.schema());
  return text;
}

void require_same_run(const std::string& checkpoint, const std::string& now, const std::filesystem::path& folder) {
  if (checkpoint == now) return;
  std::istringstream there(checkpoint), here(now);
  std::string was, is;
  bool more = true;
  while (was == is && more) {
    more = static_cast<bool>(std::getline(there, was));
    if (!more) was = "complete";
    if (!std::getline(here, is)) is = "complete";
  }
  fail("'{}' holds another run: there it is {}, here {}; give the command that was interrupted, or remove the folder.",
       folder.string(), was, is);
}

}  // namespace pointsweep
