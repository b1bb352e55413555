// SPDX-License-Identifier: MIT
#include "reference/engine.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/pipeline/sweep_engine.h"
#include "pointsweep/row_error.h"
#include "reference/reference.h"

namespace pointsweep {
namespace {

/// Brings finished points to the store, many at a time.
class Rows {
 public:
  explicit Rows(const EnginePass& run)
      : run_(run), stride_(run.layout ? run.layout->schema().stride : run.pass.plan.result_bytes) {}

  void add(const reference::Written& point) {
    rows_.push_back(run_.layout ? point.index : point.row);
    records_.resize(records_.size() + stride_);
    std::byte* to = records_.data() + records_.size() - stride_;
    if (run_.layout) {
      refused_.note_from([&] { run_.layout->assemble(point.record, point.results, 1, to, {point.row}); });
    } else {
      std::copy_n(point.results, stride_, to);
    }
    if (rows_.size() == kMost) flush();
  }

  void flush() {
    run_.store.put(rows_, records_);
    rows_.clear();
    records_.clear();
  }

  void finish() {
    flush();
    refused_.throw_if_any();
  }

 private:
  static constexpr std::size_t kMost = 1024;
  const EnginePass& run_;
  std::size_t stride_;
  std::vector<std::uint64_t> rows_;
  std::vector<std::byte> records_;
  FirstRowError refused_;  ///< error of a row that the layout of the output cannot store
};

reference::Task task_of(const PlannedPass& pass) {
  const Neighborhood& neighborhood = pass.plan.neighborhood;
  reference::Task task{
      .reach = {neighborhood.k, neighborhood.radius2()}, .rule = neighborhood.rule, .operators = {}, .kept = pass.made};
  for (const Stage& stage : pass.plan.stages) task.operators.push_back(stage.op);
  return task;
}

class ReferenceEngine final : public SweepEngine {
 public:
  std::string name() const override { return "reference"; }
  void require_can(const ChainPlan& plan, const EngineOptions& options) const override {
    if (plan.passes.empty()) return;
    if (!options.half_way_states.empty())
      fail_usage("Half-way states are those of the exact engine's cells: leave them out, or --engine reference.");
    for (const PlannedPass& pass : plan.passes)
      if (const Stage* stage = pass.connecting_stage(); stage != nullptr)
        fail_usage("The reference engine builds no graphs of neighbours: leave out '{}', or --engine reference.",
                   name_of(stage->op));
  }
  SweepStatistics sweep(const EnginePass& pass, Statistics& statistics) const override {
    Rows rows(pass);
    const reference::Statistics s =
        reference::run(pass.stream, task_of(pass.pass), [&](const reference::Written& point) { rows.add(point); },
                       {.memory_bytes = pass.memory_bytes, .progress = pass.progress});
    rows.finish();
    if (!statistics.reference) statistics.reference.emplace();
    ReferenceCounts& counts = *statistics.reference;
    counts.complete += s.complete, counts.incomplete += s.incomplete;
    counts.write_seconds += s.operators.back().seconds, counts.audit_seconds += s.audit_seconds;
    SweepStatistics out;
    out.certified = s.complete;
    out.degenerate = s.degenerate;  // for the operators of the task, which are the stages of the plan
    out.read_seconds = s.operators[0].seconds;
    out.search_seconds = s.operators[1].seconds;
    for (std::size_t i = 2; i + 1 < s.operators.size(); ++i) out.stage_seconds.push_back(s.operators[i].seconds);
    for (const reference::OperatorRecord& op : s.operators) out.buffers.emplace_back(op.name, op.series);
    out.peak_points = s.peak_points, out.mean_points = s.mean_points, out.series = s.series;
    out.lifespan_mean = s.lifespan_mean, out.lifespan_max = s.lifespan_max;
    return out;
  }
};

}  // namespace

void register_reference_engine() {
  static const ReferenceEngine engine;
  register_engine(Engine::reference, engine);
}

}  // namespace pointsweep
