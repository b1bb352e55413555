// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/preview.h"

#include <algorithm>
#include <cmath>

#include "pointsweep/error.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/demand.h"
#include "pointsweep/pipeline/output_layout.h"

namespace pointsweep {
namespace {

/// The number of the step that stage `s` belongs to.
std::size_t step_of(const SweepPlan& plan, std::size_t s) {
  const auto next = std::upper_bound(plan.steps.begin(), plan.steps.end() - 1, s);
  return static_cast<std::size_t>(next - plan.steps.begin()) - 1;
}

std::vector<ColumnPlan> plan_columns(const SweepPlan& plan) {
  std::vector<ColumnPlan> columns(plan.column_bytes.size());
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c].bytes = plan.column_bytes[c];
  const auto note = [&](const std::vector<std::uint16_t>& numbers, const std::vector<Attribute>& attributes,
                        std::size_t step) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      ColumnPlan& column = columns[numbers[i]];
      column.last_step = step;
      if (i < attributes.size()) column.attribute = attributes[i].name;
    }
  };
  for (const FileColumn& file : plan.file_columns) columns[file.column].made_by = "the file";
  for (std::size_t s = 0; s < plan.stages.size(); ++s) {
    const Stage& stage = plan.stages[s];
    const Contract contract = stage.op->contract();
    note(stage.reads, contract.reads, step_of(plan, s));
    note(stage.reads_neighbors, contract.reads_neighbors, step_of(plan, s));
    if (stage.position >= 0) note({static_cast<std::uint16_t>(stage.position)}, {}, step_of(plan, s));
    note(stage.makes, contract.makes, step_of(plan, s));
    for (const std::uint16_t made : stage.makes) columns[made].made_by = fmt::format("{} {}", s + 1, stage.op->name());
  }
  for (const ResultColumn& result : plan.results) {
    columns[result.column].written = true;
    columns[result.column].last_step = plan.step_count() - 1;
  }
  return columns;
}

std::string stages_text(const SweepPlan& plan) {
  std::string text = "stages        step  buffer\n";
  for (std::size_t s = 0; s < plan.stages.size(); ++s) {
    const std::size_t step = step_of(plan, s);
    const bool waits = step > 0 && plan.steps[step] == s;
    text += fmt::format("  {:<12}{:>4}  {}\n", fmt::format("{} {}", s + 1, plan.stages[s].op->name()), step + 1,
                        waits ? "pre-buffer: waits until all neighbours have finished the step before"
                              : "through: runs at once, with the stage or search before it");
  }
  return text;
}

std::string columns_text(const Preview& preview) {
  if (preview.columns.empty()) return "";
  std::string text = "columns             bytes  made by         needed until\n";
  for (const ColumnPlan& c : preview.columns) {
    text += fmt::format("  {:<16} {:>6}  {:<14}  {}\n", c.attribute, c.bytes, c.made_by,
                        c.written ? "written" : fmt::format("step {}", c.last_step + 1));
  }
  return text;
}

std::string results_text(const PlannedChain& planned) {
  std::string text = fmt::format("results       {} bytes a point:", planned.plan.result_bytes);
  for (const Attribute& a : planned.made) {
    text += fmt::format(" {} (", a.name);
    for (std::size_t i = 0; i < a.fields.size(); ++i) text += (i == 0 ? "" : " ") + a.fields[i];
    text += fmt::format(" {})", name_of(a.type));
  }
  return text + "\n";
}

double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

std::string neighborhood_text(const Neighborhood& n) {
  const bool limited = n.k != Neighborhood::kUnlimited, near = std::isfinite(n.radius);
  if (!limited && !near) return "all points";
  std::string text = limited ? fmt::format("the {} nearest", n.k) : "all";
  return near ? text + fmt::format(" within {}", n.radius) : text;
}

}  // namespace

Preview preview(Cloud& cloud, const Chain& chain, const RunOptions& options) {
  Preview out{.planned = plan_chain(chain, cloud.schema()), .columns = {}, .memory = {}};
  out.columns = plan_columns(out.planned.plan);
  out.points = cloud.count();
  out.budget = options.memory_bytes != 0 ? options.memory_bytes : default_memory_budget();
  const PointSource source{cloud.schema(), cloud.count(),
                           [&](std::uint64_t row, std::span<std::byte> records) { return cloud.read(row, records); }};
  const bool whole = options.order == Order::sweep;
  const std::uint64_t output_bytes = OutputLayout(cloud.schema(), out.planned.made).schema().stride;
  const MemoryDemand demand =
      memory_demand(cloud, survey(source, options.axis, false), options, whole,
                    out.planned.payload(cloud.schema()).size(), whole ? output_bytes : out.planned.plan.result_bytes);
  out.record_bytes = demand.working_record_bytes;
  out.memory = plan_memory(out.budget, out.planned.plan, demand);
  return out;
}

std::string to_text(const Preview& p) {
  const std::uint64_t slab_points = std::max<std::uint64_t>(p.memory.slab_points, 1);
  return fmt::format("points        {}\nneighbours    {}\n", p.points, neighborhood_text(p.planned.plan.neighborhood)) +
         stages_text(p.planned.plan) + columns_text(p) + results_text(p.planned) +
         fmt::format("slabs         about {} of {} points, {} bytes a point on the way, {}\n",
                     (p.points + slab_points - 1) / slab_points, slab_points, p.record_bytes,
                     p.memory.spill_stream ? "spilled" : "in memory") +
         fmt::format("memory        {:.1f} MB expected of {:.1f} MB: window {:.1f} MB, results {}\n",
                     megabytes(p.memory.expected_bytes), megabytes(p.budget), megabytes(p.memory.window_bytes),
                     p.memory.spill_results ? "spilled" : "in memory");
}

}  // namespace pointsweep
