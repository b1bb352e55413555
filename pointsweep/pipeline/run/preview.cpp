// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pointsweep/fail.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/available_memory.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/memory/sample_estimates.h"
#include "pointsweep/pipeline/output/output_set.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/pipeline/rows/other_cloud.h"
#include "pointsweep/pipeline/run/request.h"

namespace pointsweep {
namespace {

/// Returns the number of the step of stage `s`.
std::size_t step_of(const SweepPlan& plan, std::size_t s) {
  const auto next = std::upper_bound(plan.steps.begin(), plan.steps.end() - 1, s);
  return static_cast<std::size_t>(next - plan.steps.begin()) - 1;
}

std::string stages_text(const SweepPlan& plan, std::size_t first_stage) {
  if (plan.stages.empty()) return "";
  std::string text = "stages        step  buffer\n";
  for (std::size_t s = 0; s < plan.stages.size(); ++s) {
    const std::size_t step = step_of(plan, s);
    const bool waits = step > 0 && plan.steps[step] == s;
    text += fmt::format("  {:<12}{:>4}  {}\n", fmt::format("{} {}", first_stage + s + 1, name_of(plan.stages[s].op)),
                        step + 1,
                        waits ? "pre-buffer: waits until all neighbours have finished the step before"
                              : "through: runs in the same pass");
  }
  return text;
}

std::string columns_text(const std::vector<ColumnPlan>& columns) {
  if (columns.empty()) return "";
  std::string text = "columns             bytes  made by         needed until\n";
  for (const ColumnPlan& c : columns) {
    text += fmt::format("  {:<16} {:>6}  {:<14}  {}\n", c.attribute, c.bytes, c.made_by,
                        c.written ? "written" : fmt::format("step {}", c.last_step + 1));
  }
  return text;
}

/// Returns a line such as "12 bytes a point: normal (nx ny nz float32)".
std::string attributes_text(const std::vector<Attribute>& attributes) {
  std::string text = fmt::format("{} bytes a point:", bytes_of(attributes));
  for (const Attribute& a : attributes) {
    text += fmt::format(" {} (", a.name);
    for (std::size_t i = 0; i < a.fields.size(); ++i) text += (i == 0 ? "" : " ") + a.fields[i];
    text += fmt::format(" {})", name_of(a.type));
  }
  return text + "\n";
}

std::string neighborhood_text(const Neighborhood& n) {
  const bool limited = n.k != Neighborhood::kUnlimited, near = std::isfinite(n.radius);
  std::string text = limited ? fmt::format("the {} nearest", n.k) : near ? "all" : "all points";
  if (near) text += fmt::format(" within {}", n.radius);
  return n.rule ? text + "; of these " + n.rule->meaning() : text;
}

std::string slabs_text(const MemoryPlan& memory, std::uint64_t points, std::uint64_t record_bytes) {
  const std::uint64_t slab_points = std::max<std::uint64_t>(memory.slab_points, 1);
  return fmt::format("slabs         about {} of {} points, {} bytes a point on the way, {}\n",
                     (points + slab_points - 1) / slab_points, slab_points, record_bytes,
                     memory.spill_stream ? "spilled"
                     : memory.on_demand  ? "made on demand"
                                         : "in memory");
}

/// Returns the axis along which an in-order operator receives the points.
std::string axis_text(const InOrderContract& contract, std::optional<int> asked) {
  const bool in_plane = contract.places == Places::in_plane;
  if (asked && !(in_plane && *asked == 2)) return std::string(1, "xyz"[*asked]);
  return in_plane ? "x or y" : "their longest axis";
}

std::string effort_text(const Effort& effort) {
  return fmt::format("effort        {}, {}\n", effort.text, about_time_text(effort.seconds));
}

/// Describes how a pass goes over the points: for a pass over rows, the order of reading; for an in-order pass, also
/// its effort if it takes long; for a sweep, its neighbourhood, its effort, and the stage that connects neighbours.
std::string passage_text(const Preview& p, std::size_t s) {
  const PlannedPass& pass = p.planned.passes[s];
  if (pass.kind == PassKind::rows) return "reads         the rows in their order; no neighbours are searched\n";
  if (const InOrderOperator* op = pass.in_order()) {
    const InOrderContract contract = op->in_order_contract();
    const Effort& effort = p.memory.efforts[s];
    return fmt::format("reads         the points in order along {}{}; no neighbours are searched\n",
                       axis_text(contract, p.axis), contract.arrival.empty() ? "" : ", " + contract.arrival) +
           (effort.seconds < kLongSeconds ? "" : effort_text(effort));
  }
  std::string text = fmt::format("neighbours    {}\n", neighborhood_text(pass.plan.neighborhood));
  if (p.memory.efforts[s].seconds > 0) text += effort_text(p.memory.efforts[s]);
  if (const Stage* stage = pass.connecting_stage())
    text += fmt::format("connects      neighbours by edges, in the temporary folder; '{}' is known after the pass\n",
                        name_of(stage->op));
  return text;
}

std::string values_text(const PlannedPass& pass) {
  std::string text;
  for (const PlannedValue& value : pass.values)
    text += fmt::format("{}{}\n", text.empty() ? "values        " : "              ", value.reduction->text());
  return text;
}

std::string sweep_text(const Preview& p, std::size_t s, std::size_t first_stage) {
  const PlannedPass& pass = p.planned.passes[s];
  const bool goes_on = s + 1 < p.planned.passes.size();
  std::string text = p.planned.passes.size() == 1 ? "" : fmt::format("pass {} of {}\n", s + 1, p.planned.passes.size());
  if (!p.others[s].empty()) text += "other cloud   " + p.others[s] + ": put in order in the temporary folder before\n";
  text += passage_text(p, s) + stages_text(pass.plan, first_stage) + columns_text(pass.columns);
  if (pass.selects) text += "rows          are left out here; all that follows sees the others only\n";
  text += values_text(pass);
  if (goes_on && !pass.carried.empty()) text += "carried on    " + attributes_text(pass.carried);
  if (pass.kind == PassKind::rows) return text;
  text += slabs_text(p.memory.passes[s], p.points, p.memory.record_bytes[s]);
  return s == p.memory.ordered_pass ? text + "ordering      " + p.memory.order_text + "\n" : text;
}

std::string memory_text(const Preview& p) {
  std::uint64_t window = 0;
  bool spill_results = false;
  for (const MemoryPlan& pass : p.memory.passes) {
    window = std::max(window, pass.window_bytes);
    spill_results |= pass.spill_results;
  }
  std::string text = fmt::format("memory        {:.1f} MB expected of {:.1f} MB: window {:.1f} MB, results {}",
                                 megabytes(p.memory.expected_bytes), megabytes(p.budget), megabytes(window),
                                 spill_results ? "spilled" : "in memory");
  if (p.memory.row_bytes > 0)
    text += fmt::format(", {:.1f} MB between passes {}", megabytes(p.memory.row_bytes),
                        p.memory.spill_rows ? "spilled" : "in memory");
  return text + "\n";
}

/// Surveys a sample of the cloud with one reader, which needs the least memory.
Survey survey_sample(InputCloud& cloud, const EngineOptions& options) {
  const auto read = [&](std::uint64_t row, std::span<std::byte> records) { return cloud.read(row, records); };
  return survey(PointSource{cloud.schema(), cloud.count(), read}, options.axis, false);
}

}  // namespace

Preview preview(const InputCloud& input, const Chain& chain, const EngineOptions& options, const Outputs& outputs) {
  if (options.engine != Engine::exact)
    fail_usage(
        "The reference has no plan to show: it reads point by point; leave out --dry-run or --engine reference.");
  Preview out;
  out.planned = plan_chain(chain, input.schema(), needs_of(outputs, options));
  InputCloud cloud = input_of_chain(input, out.planned);
  require_own_files({cloud, outputs, options, out.planned});
  require_work({cloud, outputs, options, out.planned});
  require_lengths(cloud, out.planned.chain);
  out.notes = notes_on_inputs(cloud, out.planned.chain);
  require_outputs_possible(outputs, options);
  for (const std::optional<OtherCloud>& other : open_others(out.planned, cloud))
    out.others.push_back(other ? fmt::format("{}, {} points", other->name(), other->count()) : "");
  out.names = names_in_outputs(cloud, out.planned, outputs, options);
  require_layout({cloud, outputs, options, out.planned}, out.names);
  out.system_warning = kept_system_warning(out.planned, cloud, outputs);
  out.tiles = outputs.tiles.size();
  out.is_divided = options.division.divides();
  out.points = cloud.count();
  const bool copies = copies_rows({cloud, outputs, options, out.planned});
  out.decoded_bytes = copies ? 0 : decoded_input_bytes(cloud);
  out.axis = options.axis;
  out.budget = memory_budget(options.resources.memory_bytes);
  const std::uint64_t inputs = open_input_bytes(cloud);
  require_room_for_inputs(out.budget, inputs, cloud);
  const std::uint64_t record = layout_of_output(cloud, out.names, outputs, options).schema().stride;
  out.memory = plan_run_memory(
      out.budget, out.planned, out.points, survey_sample(cloud, options), options, record,
      [&](unsigned threads) {
        return inputs + (copies ? once_decoder_bytes(cloud, threads) : 0) +
               codec_bytes(cloud, outputs, options, record, threads);
      },
      on_demand_order(cloud, out.planned, options));
  out.aside_bytes = bytes_aside({cloud, outputs, options, out.planned}, out.names);
  for (const std::string& note : {out.memory.threads_note, obstacle_to_outputs(outputs, options)})
    if (!note.empty()) out.notes.push_back(note);
  return out;
}

std::string plan_text(Cloud& cloud, const Chain& chain, const Outputs& outputs, const RunOptions& options) {
  return to_text(preview(cloud.inputs(), chain, EngineOptions(options), outputs));
}

std::string to_text(const Preview& p) {
  std::string text = fmt::format("points        {}\n", p.points) + decoded_input_text(p.decoded_bytes);
  std::size_t first_stage = 0;
  for (std::size_t s = 0; s < p.planned.passes.size(); ++s) {
    text += sweep_text(p, s, first_stage);
    first_stage += p.planned.passes[s].plan.stages.size();
  }
  if (!p.names.made.empty()) text += "results       " + attributes_text(p.names.made);
  if (!p.names.replaced.empty()) text += "note          " + p.names.warning() + "\n";
  if (!p.system_warning.empty()) text += "note          " + p.system_warning + "\n";
  for (const std::string& note : p.notes) text += "note          " + note + "\n";
  if (p.planned.reorders)
    text += fmt::format("order         of the {} positions: the output is put in order once more, {}\n",
                        p.planned.by_moved_positions ? "moved" : "input's",
                        p.memory.reordering.spill_stream ? "spilled" : "in memory");
  if (p.tiles > 0)
    text += fmt::format("outputs       {}, one for each input, with its rows, attributes and header\n", p.tiles);
  if (p.aside_bytes > 0)
    text +=
        fmt::format("aside         up to {:.1f} MB in the temporary folder, until all points of the output are there\n",
                    megabytes(p.aside_bytes));
  if (p.is_divided) text += "outputs       the points are divided among files when all of them are made\n";
  return text + memory_text(p);
}

std::string sort_plan_text(Cloud& cloud, const std::filesystem::path& output, const RunOptions& given,
                           const std::vector<std::string>& keep) {
  const Outputs outputs{.points = output};
  require_order_kept(outputs);
  const EngineOptions options(given);
  InputCloud& input = cloud.inputs();
  const ChainPlan plan = plan_sort(input.schema(), keep);
  require_work({input, outputs, options, plan});
  const Survey seen = survey_sample(input, options);
  const std::uint64_t points = input.count(), budget = memory_budget(options.resources.memory_bytes);
  const std::uint32_t before = input.schema().stride,
                      after = OutputLayout(input.schema(), {}, plan.kept).schema().stride;
  const auto codecs = [&, inputs = open_input_bytes(input)](unsigned threads) {
    return inputs + codec_bytes(input, outputs, options, after, threads);
  };
  const RunMemory memory = plan_run_memory(budget, plan, points, seen, options, before, codecs);
  std::string text = fmt::format("points        {}\n", points) + decoded_input_text(decoded_input_bytes(input));
  text += fmt::format("order         ascending along {}, ties by x, y, z, then input row\n", "xyz"[seen.axis]);
  text += slabs_text(memory.reordering, points, before);
  text += fmt::format("results       {} bytes a point, unchanged\n", after);
  for (const std::string& note : {memory.threads_note, obstacle_to_outputs(outputs, options)})
    if (!note.empty()) text += "note          " + note + "\n";
  return text + fmt::format("memory        {:.1f} MB expected of {:.1f} MB\n",
                            megabytes(memory.reordering.expected_bytes), megabytes(budget));
}

}  // namespace pointsweep
