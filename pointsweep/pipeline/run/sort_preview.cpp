// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/sort_preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pointsweep/order/survey.h"
#include "pointsweep/order/temp_folder.h"
#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/plan/output_layout.h"
#include "pointsweep/pipeline/rows/decoded_input.h"

namespace pointsweep {

SortPreview preview_sort(InputCloud& cloud, const std::filesystem::path& output, const EngineOptions& options,
                         const std::vector<std::string>& keep) {
  if (!options.resources.temp_folder.empty()) require_temp_parent(options.resources.temp_folder);
  const KeptFields kept = keep.empty() ? KeptFields() : kept_fields(keep, {}, cloud.schema());
  const PointSource source{cloud.schema(), cloud.count(),
                           [&](std::uint64_t row, std::span<std::byte> records) { return cloud.read(row, records); }};
  const Survey seen = survey(source, options.axis, false);
  SortPreview out;
  out.points = cloud.count();
  out.decoded_bytes = decoded_input_bytes(cloud);
  out.budget = options.resources.memory_bytes != 0 ? options.resources.memory_bytes : default_memory_budget();
  out.axis = seen.axis;
  out.record_bytes = cloud.schema().stride;
  out.output_bytes = OutputLayout(cloud.schema(), {}, kept).schema().stride;
  ChainPlan only_sorts;
  only_sorts.reorders = true;
  RunMemory memory = plan_run_memory(
      out.budget, only_sorts, out.points, seen, options, out.record_bytes,
      [&](unsigned threads) { return codec_bytes(cloud, {.points = output}, out.output_bytes, threads); });
  out.memory = memory.reordering;
  out.note = std::move(memory.threads_note);
  return out;
}

std::string to_text(const SortPreview& p) {
  const auto megabytes = [](std::uint64_t bytes) { return static_cast<double>(bytes) / (1 << 20); };
  const std::uint64_t slab_points = std::max<std::uint64_t>(p.memory.slab_points, 1);
  std::string text = fmt::format("points        {}\n", p.points) + decoded_input_text(p.decoded_bytes);
  text += fmt::format("order         ascending along {}, ties by x, y, z, then input row\n", "xyz"[p.axis]);
  text += fmt::format("slabs         about {} of {} points, {} bytes a point on the way, {}\n",
                      (p.points + slab_points - 1) / slab_points, slab_points, p.record_bytes,
                      p.memory.spill_stream ? "spilled" : "in memory");
  text += fmt::format("results       {} bytes a point, unchanged\n", p.output_bytes);
  if (!p.note.empty()) text += "note          " + p.note + "\n";
  return text + fmt::format("memory        {:.1f} MB expected of {:.1f} MB\n", megabytes(p.memory.expected_bytes),
                            megabytes(p.budget));
}

}  // namespace pointsweep
