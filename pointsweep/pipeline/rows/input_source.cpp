// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/input_source.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

namespace pointsweep {
namespace {

/// Returns boxes in x and y that contain all points kept by the selects at the beginning of the chain.
std::vector<Box> first_extents(const ChainPlan& plan) {
  std::vector<Box> extents;
  for (const GraphNode& node : plan.graph.nodes) {
    if (node.op() == nullptr) continue;  // not an operator, so it moves no point
    const auto* const select = std::get_if<std::shared_ptr<const SelectOperator>>(node.op());
    if (select == nullptr) break;
    if (const std::optional<Box> extent = (*select)->extent()) extents.push_back(*extent);
  }
  return extents;
}

/// Returns whether two boxes touch in x and y, or have a gap of at most a step of the grid of the file, since programs
/// round the boxes of nodes.
bool meet(const Box& a, const Box& b, Vec3 step) {
  return a.lo.x <= b.hi.x + step.x && b.lo.x <= a.hi.x + step.x && a.lo.y <= b.hi.y + step.y &&
         b.lo.y <= a.hi.y + step.y;
}

}  // namespace

InputCloud cropped_input(const InputCloud& cloud, const ChainPlan& plan) {
  const std::vector<Box> extents = first_extents(plan);
  if (extents.empty() || plan.graph.reads_input_rows()) return cloud;
  const Vec3 step = cloud.las() ? cloud.las()->grid.scale : Vec3{};
  return cloud.with_chunks([&](const Chunk& chunk) {
    return !chunk.depth || !chunk.bounds ||
           std::ranges::all_of(extents, [&](const Box& extent) { return meet(*chunk.bounds, extent, step); });
  });
}

InputCloud input_of_chain(const InputCloud& cloud, const ChainPlan& plan, std::uint64_t first) {
  InputCloud cropped = cropped_input(cloud, plan);
  return plan.graph.reads_input_rows() ? cropped.numbered(first) : cropped;
}

PointSource source_of(InputCloud& cloud, const std::function<void(std::size_t rows)>& note) {
  const auto noted = [note](std::size_t rows) {
    note(rows);
    return rows;
  };
  return {.schema = cloud.schema(),
          .count = cloud.count(),
          .read = [&cloud, noted](std::uint64_t row,
                                  std::span<std::byte> records) { return noted(cloud.read(row, records)); },
          .for_thread = [&cloud, noted](const std::vector<std::size_t>& wanted) -> ReadRows {
            const std::shared_ptr<RowDecoder> own = cloud.decoder(wanted);
            if (!own) return {};
            return [own, noted](std::uint64_t row, std::span<std::byte> records) {
              return noted(own->read(row, records));
            };
          },
          .chunk_end = [&cloud](std::uint64_t row) { return cloud.chunk_end(row); }};
}

}  // namespace pointsweep
