// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/request.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

#include "pointsweep/fail.h"
#include "pointsweep/files.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/pipeline/available_memory.h"
#include "pointsweep/pipeline/checkpoint/checkpoints.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/memory_plan.h"
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/pipeline/output/output_set.h"
#include "pointsweep/pipeline/plan/output_layout.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/pipeline/statistics.h"
#include "pointsweep/pipeline/sweep_engine.h"
#include "pointsweep/program/standard_streams.h"
#include "pointsweep/storage/local/output_file.h"
#include "pointsweep/storage/local/place.h"
#include "pointsweep/storage/local/temp_folder.h"

namespace pointsweep {
namespace {

/// Returns the paths of the point files, arrays and tiles that a run writes, and of its half-way states. Empty paths
/// stand for files that are not requested.
std::vector<std::filesystem::path> written_files(const Outputs& outputs, const EngineOptions& options) {
  std::vector<std::filesystem::path> written = {outputs.points, options.half_way_states};
  for (const auto& [name, path] : outputs.arrays) written.push_back(path);
  written.insert(written.end(), outputs.tiles.begin(), outputs.tiles.end());
  return written;
}

OutputNames names_of_output(const Request& request) {
  const auto& [cloud, outputs, options, plan] = request;
  const bool is_sort = plan.passes.empty();
  if (is_sort || (outputs.points.empty() && outputs.tiles.empty() && !outputs.writer))
    return {plan.made, plan.kept, {}};
  return names_in_outputs(cloud, plan, outputs, options);
}

/// Warns of each k of a sweep that is more than the number of other points in the cloud. Sets Statistics::k to the k of
/// the first sweep, or to 0 if this k is unlimited.
void note_neighborhoods(const Request& request, const RunReport& report) {
  std::set<std::size_t> noted;
  for (const PlannedPass& pass : request.plan.passes) {
    if (pass.kind != PassKind::sweep) continue;
    const std::size_t k = pass.plan.neighborhood.k;
    const bool limited = k != Neighborhood::kUnlimited;
    if (noted.empty()) report.statistics.k = limited ? k : 0;
    if (!noted.insert(k).second || !limited || k < request.cloud.count()) continue;
    report.warn(fmt::format("k = {} is more than the {} other points there are: neighbourhoods hold all of them.", k,
                            request.cloud.count() - 1));
  }
}

/// Returns whether the format of the output needs bounds or values of the points before the first record.
bool needs_points_before(const InputCloud& cloud, const Outputs& outputs, const FileLayout& layout) {
  const Format* const format = format_of_output(outputs.points);
  return needs_bounds(format, cloud.schema(), layout) ||
         (format != nullptr && format->values_need_points != nullptr && format->values_need_points(cloud, layout));
}

/// Throws Error unless the temporary folder has room for bytes_aside() and for decoded inputs. Does not check the room
/// if bytes_aside() is 0.
void require_room_aside(const Request& request, const OutputNames& names) {
  const std::uint64_t aside = bytes_aside(request, names);
  if (aside == 0) return;
  const std::uint64_t needed = aside + (copies_rows(request) ? 0 : decoded_input_bytes(request.cloud));
  const std::filesystem::path folder = temp_parent(request.options.resources.temp_folder);
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder, error);
  if (error || space.available >= needed) return;
  fail(
      "{}: has {} bytes free, and about {} are needed there for temporary files while {} is written; free some there, "
      "or name another folder with --temp-dir.",
      folder.string(), space.available, needed, request.outputs.points.string());
}

}  // namespace

ChainPlan plan_sort(const Schema& input, const std::vector<std::string>& keep) {
  ChainPlan plan;
  plan.chain.keep = keep;
  if (!keep.empty()) plan.kept = kept_fields(keep, {}, input);
  plan.reorders = true;
  return plan;
}

bool copies_rows(const Request& request) {
  const auto& [cloud, outputs, options, plan] = request;
  const bool plain = outputs.tiles.empty() && options.resume_folder.empty() && options.order == Order::input &&
                     engine_of(options.engine) == nullptr;
  if (!plain || !plan.only_copies() || needs_points_before(cloud, outputs, options.layout)) return false;
  return once_decoder_bytes(cloud, threads_asked_for(options)) <= memory_budget(options.resources.memory_bytes) / 2;
}

void require_own_files(const Request& request) {
  std::vector<std::filesystem::path> read;
  for (std::size_t i = 0; i < request.cloud.readers().size(); ++i)
    if (request.cloud.states()[i].is_known()) read.push_back(request.cloud.readers()[i]->info().path);
  require_separate_files(read, written_files(request.outputs, request.options));
  if (!request.options.division.divides()) return;
  for (const std::filesystem::path& input : read)
    if (share_folder(input, request.outputs.points))
      fail_usage("{}: is in the folder of the outputs, one of which might replace it; name another folder.",
                 input.string());
}

std::string obstacle_to_outputs(const Outputs& outputs, const EngineOptions& options) {
  for (const std::filesystem::path& path : written_files(outputs, options)) {
    if (path.empty() || is_standard_output(path) || (options.division.divides() && path == outputs.points)) continue;
    if (!outputs.tiles.empty() && !std::filesystem::exists(path.parent_path())) continue;
    try {
      OutputFile::require_possible(path, options.overwrite);
    } catch (const Error& error) {
      return error.what();
    }
  }
  return "";
}

void require_work(const Request& request) {
  const std::filesystem::path& temp_folder = request.options.resources.temp_folder;
  if (!temp_folder.empty()) require_temp_parent(temp_folder);
  const auto& readers = request.cloud.readers();
  if (request.cloud.count() == 0)
    fail("{}: has no points, so there is nothing to do.",
         readers.empty() ? "The input" : readers.front()->info().path.string());
}

bool reads_attributes(const ChainPlan& plan) {
  return std::ranges::any_of(plan.passes, [](const PlannedPass& pass) { return !pass.payload().empty(); });
}

Statistics first_counts(const Request& request, const NonfiniteRows& dropped) {
  const InputCloud& cloud = request.cloud;
  Statistics counts;
  counts.points = counts.points_written = cloud.count();
  counts.threads = threads_asked_for(request.options);
  counts.memory_budget_bytes = memory_budget(request.options.resources.memory_bytes);
  counts.machine = machine_description();
  for (const auto& reader : cloud.readers()) {
    const auto& warnings = reader->info().warnings;
    counts.warnings.insert(counts.warnings.end(), warnings.begin(), warnings.end());
  }
  // If each input has its own output, this output lacks the attributes that the input lacks. Then a warning about
  // missing attributes is needed only if a stage reads 0 for them.
  const bool fills = request.outputs.tiles.empty() || reads_attributes(request.plan);
  for (const std::string& warning : cloud.warnings())
    if (fills || std::ranges::find(cloud.missing_attributes(), warning) == cloud.missing_attributes().end())
      counts.warnings.push_back(warning);
  counts.dropped = counts.nonfinite = dropped.count;
  counts.nonfinite_rows = dropped.rows;
  return counts;
}

OutputNames check_request(const Request& request, const RunReport& report) {
  const auto& [cloud, outputs, options, plan] = request;
  if (options.order == Order::sweep && !outputs.arrays.empty())
    fail_usage("Arrays have their rows in input order: leave out --order sweep.");
  require_outputs(outputs);
  require_lengths(cloud, plan.chain);
  for (const std::string& sentence : notes_on_inputs(cloud, plan.chain)) report.note(sentence);
  require_outputs_possible(outputs, options);
  OutputNames names = names_of_output(request);
  require_layout(request, names);
  report.warn(names.warning());
  report.warn(kept_system_warning(plan, cloud, outputs));
  if (const SweepEngine* engine = engine_of(options.engine)) engine->require_can(plan, options);
  note_neighborhoods(request, report);
  require_room_for_inputs(memory_budget(options.resources.memory_bytes), open_input_bytes(cloud), cloud);
  require_room_aside(request, names);
  return names;
}

void require_layout(const Request& request, const OutputNames& names) {
  const auto& [cloud, outputs, options, plan] = request;
  const Format* const format = format_of_output(outputs.points);
  if (format == nullptr || format->stored_coordinate == nullptr) return;
  const OutputLayout layout = layout_of_output(cloud, names, outputs, options);
  const Box somewhere{Vec3{}, Vec3{}};
  format->stored_coordinate(
      plan_of_output(cloud, layout.schema(), names, outputs, options, {.bounds = somewhere, .values = nullptr}, {}));
}

std::uint64_t bytes_aside(const Request& request, const OutputNames& names) {
  const auto& [cloud, outputs, options, plan] = request;
  // Files that are written one after another do not need this space at the same time.
  if (!outputs.tiles.empty() || options.division.divides()) return 0;
  return aside_bytes(outputs, cloud.count(), layout_of_output(cloud, names, outputs, options).schema().stride,
                     memory_budget(options.resources.memory_bytes), threads_asked_for(options));
}

OtherClouds open_other_clouds(const Request& request, const RunReport& report) {
  OtherClouds others = open_others(request.plan, request.cloud);
  for (const std::optional<OtherCloud>& other : others) {
    if (!other) continue;
    require_separate_files(other->files(), written_files(request.outputs, request.options));
    for (const std::string& warning : other->warnings()) report.warn(warning);
  }
  return others;
}

std::optional<std::string> identity_of(const Request& request, const OtherClouds& others) {
  const auto& [cloud, outputs, options, plan] = request;
  if (options.resume_folder.empty()) return std::nullopt;
  if (engine_of(options.engine) != nullptr || !options.half_way_states.empty())
    fail_usage("A run of the reference engine, or one that notes half-way states, cannot be resumed.");
  std::string identity = run_identity(cloud, plan, outputs, options);
  for (const std::optional<OtherCloud>& other : others)
    if (other) identity += other->identity();
  return identity;
}

}  // namespace pointsweep
