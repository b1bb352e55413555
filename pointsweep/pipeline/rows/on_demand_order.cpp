// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/on_demand_order.h"

#include <fmt/format.h>

#include <algorithm>

namespace pointsweep {
namespace {

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
