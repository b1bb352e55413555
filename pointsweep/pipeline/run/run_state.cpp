// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/run_state.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <thread>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/same_file.h"
#include "pointsweep/operators/kinds/moved_bounds.h"
#include "pointsweep/pipeline/rows/cloud_source.h"
#include "pointsweep/pipeline/statistics.h"

namespace pointsweep {
namespace {

/// Throws UsageError where an output is an input or another output.
InputCloud& with_own_files(InputCloud& cloud, const Outputs& outputs, const EngineOptions& options) {
  std::vector<std::filesystem::path> read;
  for (std::size_t i = 0; i < cloud.readers().size(); ++i)
    if (cloud.states()[i].is_known()) read.push_back(cloud.readers()[i]->info().path);
  require_separate_files(read, written_files(outputs, options));
  return cloud;
}

/// Returns whether a stage reads attributes of the input.
bool reads_attributes(const ChainPlan& plan) {
  return std::ranges::any_of(plan.passes, [](const PlannedPass& pass) { return !pass.payload().empty(); });
}

/// Returns the statistics of the input, before the first phase.
Statistics first_counts(const InputCloud& cloud, const FiniteInput& input, const Outputs& outputs,
                        const ChainPlan& plan, const EngineOptions& options) {
  Statistics counts;
  counts.points = counts.points_written = cloud.count();
  counts.threads =
      options.resources.threads != 0 ? options.resources.threads : std::max(1u, std::thread::hardware_concurrency());
  counts.memory_budget_bytes =
      options.resources.memory_bytes != 0 ? options.resources.memory_bytes : default_memory_budget();
  counts.machine = machine_description();
  for (const auto& reader : cloud.readers()) {
    const auto& warnings = reader->info().warnings;
    counts.warnings.insert(counts.warnings.end(), warnings.begin(), warnings.end());
  }
  // A tile has no more attributes than its input.
  const bool fills = outputs.tiles.empty() || reads_attributes(plan);
  for (const std::string& warning : cloud.warnings())
    if (fills || std::ranges::find(cloud.missing_attributes(), warning) == cloud.missing_attributes().end())
      counts.warnings.push_back(warning);
  counts.dropped = counts.nonfinite = input.dropped().count;
  counts.nonfinite_rows = input.dropped().rows;
  return counts;
}

}  // namespace

std::vector<std::filesystem::path> written_files(const Outputs& outputs, const EngineOptions& options) {
  std::vector<std::filesystem::path> written = {outputs.points, options.half_way_states};
  for (const auto& [name, path] : outputs.arrays) written.push_back(path);
  written.insert(written.end(), outputs.tiles.begin(), outputs.tiles.end());
  return written;
}

RunState::RunState(InputCloud& read, const Outputs& written, const EngineOptions& given, ChainPlan planned)
    : cloud(with_own_files(read, written, given)),
      outputs(written),
      options(given),
      plan(std::move(planned)),
      input(read, written, given),
      statistics(first_counts(read, input, written, plan, given)) {
  if (!options.resources.temp_folder.empty()) require_temp_parent(options.resources.temp_folder);
  if (cloud.count() == 0) fail("{}: has no points, so there is nothing to do.", name_of_cloud());
  if (options.observer != nullptr)
    for (const std::string& sentence : statistics.warnings) options.observer->on_warning(sentence);
  warn(input.warning());
}

std::optional<Box> RunState::moved_bounds() const {
  if (!plan.graph.moved_bounds || is_empty()) return std::nullopt;
  return box_of(values.at(*plan.graph.moved_bounds));
}

std::string RunState::name_of_cloud() const {
  return cloud.readers().empty() ? "The input" : cloud.readers().front()->info().path.string();
}

SpillPlace RunState::place(const char* kind, std::size_t p, bool spills) const {
  if (checkpoints) return checkpoints->place(kind, p);
  return spills ? &*folder : nullptr;
}

PointSource RunState::cloud_source() {
  return source_of(cloud,
                   [this](std::size_t n) { std::atomic_ref(statistics.bytes_read) += n * cloud.schema().stride; });
}

void RunState::warn(const std::string& sentence) {
  if (sentence.empty()) return;
  statistics.warnings.push_back(sentence);
  if (options.observer != nullptr) options.observer->on_warning(sentence);
}

void RunState::note(const std::string& sentence) {
  statistics.warnings.push_back(sentence);
  if (options.observer != nullptr) options.observer->on_note(sentence);
}

void RunState::report(const char* phase, std::uint64_t done, std::uint64_t active) const {
  if (options.observer != nullptr) options.observer->on_progress({phase, done, cloud.count(), active});
}

std::vector<std::uint64_t> RunState::rows_of_cloud(std::vector<std::uint64_t> of_rows) const {
  if (cloud.selection() == nullptr) return of_rows;
  SelectionCursor kept(*cloud.selection());
  for (std::uint64_t& row : of_rows) row = kept.row_of(row);
  return of_rows;
}

void RunState::number_degenerate_rows(std::size_t first) {
  for (std::size_t r = first; r < statistics.degenerate_results.size(); ++r)
    statistics.degenerate_results[r].rows = rows_of_cloud(std::move(statistics.degenerate_results[r].rows));
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace pointsweep
