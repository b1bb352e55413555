// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/kept_system.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <vector>

#include "pointsweep/pipeline/output/output_formats.h"

namespace pointsweep {
namespace {

struct Moves {
  std::vector<std::string> stages;  ///< names, each once
  std::array<bool, 3> axes{};       ///< x, y, z
};

/// Adds what the stage `op`, which makes positions, may take to another system.
void add_moves(const LocalOperator& op, Moves& moves) {
  const std::array<bool, 3> axes = op.changes_system();
  if (axes == std::array<bool, 3>{}) return;
  for (std::size_t axis = 0; axis < 3; ++axis) moves.axes[axis] |= axes[axis];
  if (std::ranges::find(moves.stages, op.name()) == moves.stages.end()) moves.stages.push_back(op.name());
}

Moves moves_of(const ChainGraph& graph) {
  Moves moves;
  for (const GraphNode& node : graph.nodes)
    for (const std::size_t v : node.makes)
      if (const auto* op = std::get_if<std::shared_ptr<const LocalOperator>>(node.op());
          op != nullptr && graph.versions[v].attribute.name == position_attribute().name)
        add_moves(**op, moves);
  return moves;
}

}  // namespace

std::string kept_system_warning(const ChainPlan& plan, const std::optional<Crs>& crs, const Outputs& outputs) {
  const auto holds_crs = [](const OutputFormat& output) { return output.format->holds_crs; };
  if (!crs || std::ranges::none_of(output_formats(outputs), holds_crs)) return "";
  const Moves moves = moves_of(plan.graph);
  if (!moves.axes[0] && !moves.axes[1] && (!moves.axes[2] || crs->vertical_epsg == 0)) return "";
  std::vector<std::string> axes;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (moves.axes[axis]) axes.push_back({"xyz"[axis]});
  return fmt::format(
      "{} changes {}, and the output states the coordinate system of the input, {}; if the new coordinates are in "
      "another system, state that with another program, e.g. 'pdal translate OUT NEW --writers.las.a_srs=EPSG:...'.",
      fmt::join(moves.stages, ", "), fmt::join(axes, ", "), short_text(*crs));
}

}  // namespace pointsweep
