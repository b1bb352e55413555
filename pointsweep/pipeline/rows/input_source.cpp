// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/input_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <variant>

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

/// Returns the reason why the request rules out an order on demand (OnDemandOrder::why_not); empty if it does not.
std::string ruled_out_by_request(const ChainPlan& planned, const EngineOptions& options) {
  const bool forced = options.ordering == Ordering::on_demand;
  if (options.ordering == Ordering::distribution) return "it was asked for";
  if (options.engine != Engine::exact) return "the reference engine reads slabs more than once";
  if (!options.resume_folder.empty()) return "--resume keeps the points in order in its folder";
  if (!options.half_way_states.empty()) return "half-way states are noted";
  if (options.spill && !forced) return "everything is to be spilled";
  const std::size_t first = first_ordered_pass(planned);
  if (first < planned.passes.size() && planned.passes[first].has_places())
    return fmt::format("{} does not order points by their positions", planned.passes[first].in_order()->name());
  for (std::size_t p = 0; p < first; ++p)
    if (planned.passes[p].selects || !planned.passes[p].carried.empty())
      return "a pass before leaves out rows or carries values on";
  return "";
}

/// Returns the reason why the inputs rule out an order on demand (OnDemandOrder::why_not); empty if they do not.
std::string ruled_out_by_inputs(const InputCloud& cloud) {
  if (cloud.selection() != nullptr) return "rows are left out";
  for (const auto& reader : cloud.readers())
    if (!reader->decodes_any_range() && !reader->info().decode_once)
      return fmt::format("{} has to be read from its beginning", reader->info().path.filename().string());
  return "";
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

std::size_t first_ordered_pass(const ChainPlan& planned) {
  const auto is_ordered = [](const PlannedPass& pass) { return pass.kind != PassKind::rows; };
  return static_cast<std::size_t>(std::ranges::find_if(planned.passes, is_ordered) - planned.passes.begin());
}

OnDemandOrder on_demand_order(const InputCloud& cloud, const ChainPlan& planned, const EngineOptions& options) {
  OnDemandOrder order;
  order.why_not = ruled_out_by_request(planned, options);
  if (order.why_not.empty()) order.why_not = ruled_out_by_inputs(cloud);
  if (!order.why_not.empty()) return order;
  if (const Reader* without = cloud.stated_boxes(order.boxes);
      without != nullptr && options.ordering != Ordering::on_demand)
    order.why_not = fmt::format("{} does not state where its points lie", without->info().path.filename().string());
  return order;
}

}  // namespace pointsweep
