// SPDX-License-Identifier: MIT
/// Passes with a stage that connects points: a sweep in which the stage emits edges, and the values that each point
/// then gets from its component of the graph.
#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <vector>

#include "pointsweep/connect/bucketed_graph.h"
#include "pointsweep/connect/components.h"
#include "pointsweep/free_memory.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/part/record_list.h"
#include "pointsweep/part/stored_graph.h"
#include "pointsweep/part/tile_forest.h"
#include "pointsweep/part/tile_graph.h"
#include "pointsweep/pipeline/output/result_sinks.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/points/record_map.h"
#include "pointsweep/sweep/stage_runner.h"

namespace pointsweep {
namespace {

/// A part of the results of a pass: either the results of its connecting stage, or all other results.
struct ResultPart {
  RecordMap map = {};       ///< copies a record of the part into a record of the pass
  std::uint32_t bytes = 0;  ///< bytes of a record of the part
};

/// Returns the part that the connecting stage makes, with all values of its contract in order. `map` copies only
/// values that the pass needs.
ResultPart connected_part(const SweepPlan& plan, const Stage& stage) {
  ResultPart part;
  for (const std::uint16_t column : stage.makes) {
    for (const ResultColumn& result : plan.results)
      if (result.column == column) part.map.add(part.bytes, result.offset, result.bytes);
    part.bytes += plan.column_bytes[column];
  }
  return part;
}

/// Removes the columns that the connecting stage makes from the results of `plan`.
void leave_out_connected(SweepPlan& plan, const Stage& stage) {
  std::erase_if(plan.results, [&](const ResultColumn& result) {
    return std::ranges::find(stage.makes, result.column) != stage.makes.end();
  });
}

/// Returns the part of the results that all stages except the connecting stage make. Keeps only this part in the
/// results of `plan`.
ResultPart take_swept_part(SweepPlan& plan, const Stage& stage) {
  ResultPart part;
  std::vector<ResultColumn> results;
  for (const ResultColumn& result : plan.results) {
    if (std::ranges::find(stage.makes, result.column) != stage.makes.end()) continue;
    part.map.add(part.bytes, result.offset, result.bytes);
    results.push_back({result.column, part.bytes, result.bytes});
    part.bytes += result.bytes;
  }
  plan.results = std::move(results);
  plan.result_bytes = part.bytes;
  return part;
}

class NoSink final : public Sink {
 public:
  void finished(const Finished&) override {}
};

/// Adds a record of `bytes` bytes for each point to `store`, with the values of the point's component at the offsets of
/// `part`.
void put_values(const Components& components, const ConnectOperator& op, const ResultPart& part, RowStore& store,
                std::size_t bytes) {
  BatchedRows rows(store, bytes);
  std::vector<std::byte> values(part.bytes);
  components.for_each_point([&](std::uint64_t row, const ComponentLabel& label) {
    op.put_values(label, values.data());
    part.map.copy(values.data(), rows.add(row));
  });
  rows.flush();
}

/// Combines the records of the sweep and the records of the connecting stage into records of results, row by row.
void put_both(RowStore& swept, const ResultPart& swept_part, RowStore& connected, const ResultPart& connected_part,
              const SpillPlace& spill, std::uint64_t count, RowStore& results, std::size_t bytes) {
  RowFile by_row(count, connected_part.bytes, spill);
  connected.drain([&](std::uint64_t, std::span<const std::byte> records) { by_row.append(records); });
  std::vector<std::byte> of_graph;
  BatchedRows rows(results, bytes);
  swept.drain([&](std::uint64_t first, std::span<const std::byte> records) {
    const std::size_t n = records.size() / swept_part.bytes;
    of_graph.resize(n * connected_part.bytes);
    by_row.read(first, of_graph);
    for (std::size_t i = 0; i < n; ++i) {
      std::byte* to = rows.add(first + i);
      swept_part.map.copy(records.data() + i * swept_part.bytes, to);
      connected_part.map.copy(of_graph.data() + i * connected_part.bytes, to);
    }
  });
  rows.flush();
}

}  // namespace

SweepStatistics sweep_and_connect(const Context& context, const PlannedPass& pass, const Ordered& points,
                                  SweepOptions options, RowStore& results) {
  const Stage& stage = *pass.connecting_stage();
  const ConnectOperator& op = *stage.connects();
  RunPlaces& places = context.places;
  EdgeBuckets edges(bucket_begins(points.stream, points.bucket_places), points.stream.axis(), op.weighted(),
                    op.votes() != nullptr ? op.votes()->ballot_bytes() : 0, places.scratch());
  SweepPlan plan = pass.plan;
  const ResultPart swept_part = take_swept_part(plan, stage), graph_part = connected_part(pass.plan, stage);
  const SpillPlace spill = &places.folder();
  const MemoryPlan& memory = points.memory;
  const std::uint64_t count = context.cloud.count();
  // The buffers of `swept` and `of_graph` are in use at the same time, so each has half of the memory. `results` then
  // takes their records.
  const std::size_t buffer = std::max<std::size_t>(memory.result_buffer_bytes / 2, 1 << 20);
  std::optional<RowStore> swept;
  std::unique_ptr<Sink> sink = std::make_unique<NoSink>();
  if (swept_part.bytes > 0) {
    swept.emplace(count, std::vector<std::byte>(swept_part.bytes), spill, buffer);
    sink = std::make_unique<InputOrderSink>(*swept, swept_part.bytes);
  }
  options.edges = &edges;
  SweepStatistics done = sweep(points.stream, plan, *sink, options);
  return_free_memory_above(options.spare_bytes);
  const auto start = std::chrono::steady_clock::now();
  const ComponentsSetup setup{.votes = op.votes(),
                              .make_scratch = places.scratch(),
                              .memory_bytes = memory.recall_bytes / 2,
                              .progress = context.progress_of("connecting")};
  const Components components(edges, setup);
  const std::size_t bytes = pass.plan.result_bytes;
  if (swept) {
    RowStore of_graph(count, std::vector<std::byte>(graph_part.bytes), spill, buffer);
    ResultPart whole{.bytes = graph_part.bytes};
    whole.map.add(0, 0, whole.bytes);
    put_values(components, op, whole, of_graph, graph_part.bytes);
    put_both(*swept, swept_part, of_graph, graph_part, spill, count, results, bytes);
    context.statistics().bytes_spilled += swept->spilled_bytes() + 2 * of_graph.spilled_bytes();
  } else {
    put_values(components, op, graph_part, results, bytes);
  }
  context.statistics().bytes_spilled += edges.bytes() + components.log_bytes();
  done.stage_seconds[static_cast<std::size_t>(&stage - pass.plan.stages.data())] += seconds_since(start);
  return done;
}

SweepStatistics sweep_and_leave_graph(const Context& context, const PlannedPass& pass, const Ordered& points,
                                      SweepOptions options, const PlaceOfTile& graph, RowStore& results) {
  const Stage& stage = *pass.connecting_stage();
  const ConnectOperator& op = *stage.connects();
  RunPlaces& places = context.places;
  EdgeBuckets among(bucket_begins(points.stream, points.bucket_places), points.stream.axis(), op.weighted(),
                    op.votes() != nullptr ? op.votes()->ballot_bytes() : 0, places.scratch());
  const RowsOfTile rows{points.first_row, context.cloud.count()};
  const TileGraphSetup setup{op.votes(), places.scratch(), &places.folder(), points.memory.recall_bytes / 2,
                             context.progress_of("connecting")};
  std::optional<SortedCrossings> by_row;        // edges to other tiles, of a graph without weights
  std::optional<RecordListWriter> with_weight;  // edges to other tiles, of a graph with weights
  if (op.weighted())
    with_weight.emplace(*graph.scratch, graph.name + ".crossings", sizeof(ForestEdge));
  else
    by_row.emplace(places.scratch(), setup.memory_bytes / 4, rows.count);
  TileEdges edges(among, rows, [&](std::span<const ForestEdge> crossings) {
    if (with_weight) return with_weight->append(std::as_bytes(crossings));
    for (const ForestEdge& edge : crossings)
      by_row->add(rows.has(edge.a.row) ? Crossing{edge.a.row, edge.b.row} : Crossing{edge.b.row, edge.a.row});
  });
  options.edges = &edges;
  SweepPlan plan = pass.plan;
  leave_out_connected(plan, stage);
  InputOrderSink sink(results, plan.result_bytes, points.first_row);
  const SweepStatistics done = sweep(points.stream, plan, sink, options);
  return_free_memory_above(options.spare_bytes);
  if (op.weighted()) {
    with_weight->seal();
    store_graph(among, op.votes() != nullptr ? op.votes()->ballot_bytes() : 0, *graph.scratch, graph.name);
  } else {
    leave_graph(among, *by_row, rows, setup, *graph.scratch, graph.name);
  }
  return done;
}

void label_points(const Context& context, const PlannedPass& pass, const MemoryPlan& memory, const LabelledTile& tile,
                  RowStore& results) {
  const Stage& stage = *pass.connecting_stage();
  const ConnectOperator& op = *stage.connects();
  const ResultPart part = connected_part(pass.plan, stage);
  const std::size_t bytes = pass.plan.result_bytes;
  const std::size_t label_bytes = 1 + part.bytes;  // the first byte is 1 where the point is in a component
  RunPlaces& places = context.places;
  const TileGraphSetup setup{op.votes(), places.scratch(), &places.folder(), memory.recall_bytes / 2, {}};
  RowStore labels(context.cloud.count(), std::vector<std::byte>(label_bytes), setup.spill,
                  std::max<std::size_t>(memory.result_buffer_bytes / 2, 1 << 20));
  BatchedRows put(labels, label_bytes);
  const auto use = [&](std::uint64_t row, const ComponentLabel& label) {
    std::byte* const record = put.add(row);
    *record = std::byte{1};
    op.put_values(label, record + 1);
  };
  if (op.weighted())
    for_each_sign(*tile.graph.scratch, tile.graph.name, tile.joined, context.part->tile, use);
  else
    for_each_label(*tile.graph.scratch, tile.graph.name, tile.joined, context.part->tile, setup, use);
  put.flush();
  std::vector<std::byte> records;
  BatchedRows rows(results, bytes);
  labels.drain([&](std::uint64_t first, std::span<const std::byte> some) {
    const std::size_t n = some.size() / label_bytes;
    records.resize(n * bytes);
    tile.swept.read(first, records);
    for (std::size_t i = 0; i < n; ++i) {
      std::byte* const record = records.data() + i * bytes;
      const std::byte* const from = some.data() + i * label_bytes;
      if (*from == std::byte{1}) part.map.copy(from + 1, record);
      std::memcpy(rows.add(first + i), record, bytes);
    }
  });
  rows.flush();
}

}  // namespace pointsweep
