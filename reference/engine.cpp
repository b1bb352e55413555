// SPDX-License-Identifier: MIT
#include "reference/engine.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/pipeline/sweep_engine.h"
#include "pointsweep/row_error.h"
#include "reference/audit.h"
#include "reference/buffers.h"
#include "reference/stream_operators.h"

namespace pointsweep {
namespace reference {
namespace {

/// Collects finished points and writes them to the row store of the pass, kMost at a time.
class Rows {
 public:
  explicit Rows(const EnginePass& run)
      : run_(run), stride_(run.layout ? run.layout->schema().stride : run.pass.plan.result_bytes) {}

  /// Adds a point with its working record and its result record.
  void add(const StreamPoint& point, const std::byte* record, const std::byte* results) {
    rows_.push_back(run_.layout ? point.index : point.row);
    records_.resize(records_.size() + stride_);
    std::byte* to = records_.data() + records_.size() - stride_;
    if (run_.layout) {
      refused_.note_from([&] { run_.layout->assemble(record, results, 1, to, {point.row}); });
    } else {
      std::copy_n(results, stride_, to);
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

std::vector<StageOperator> operators_of(const PlannedPass& pass) {
  std::vector<StageOperator> operators;
  for (const pointsweep::Stage& stage : pass.plan.stages) operators.push_back(stage.op);
  return operators;
}

using Clock = std::chrono::steady_clock;
constexpr std::uint64_t kRows = 1000;              ///< most entries of a series of buffer sizes
constexpr std::uint64_t kMeasurePoints = 1 << 12;  ///< least number of points read between two measurements of memory
constexpr std::uint64_t kNodeBytes = 128;          ///< approximate bytes of a point in a kD-heap and in queues
constexpr double kReportSeconds = 0.1;
constexpr std::uint64_t kReportPoints = 1024;  ///< points written between two readings of the clock

/// The main routine of Figure 16.
class Pipeline {
 public:
  explicit Pipeline(const EnginePass& run)
      : run_(run),
        rows_(run),
        fields_(run.stream.record_schema(), rule(), operators_of(run.pass), run.pass.made),
        shortening_(rule(), fields_),
        audit_(run.stream, reach(), shortening_),
        read_(run.stream, fields_, reach(), active_),
        nearest_(run.stream.axis(), shortening_),
        write_(active_, [this](StreamPoint& point) { write_point(point); }) {
    append("read", read_);
    append("knn", nearest_);
    for (const Stage& stage : fields_.stages()) append_stage(stage);
    append("write", write_);
  }

  /// Returns the statistics of the sweep. Adds the counts and times that only this engine has to `counts`.
  SweepStatistics run(ReferenceCounts& counts) {
    const std::uint64_t n = read_.total();
    now_ = reported_ = Clock::now();
    while (write_.position() < n) {
      for (std::size_t i = 0; i < operators_.size(); ++i) {
        operators_[i]->pull_push();
        seconds_[i] += lap();
        if (operators_[i] == &nearest_) audit();
      }
      assert((read_.position() < n || nearest_.searched() > 0 || active_.empty()) && "the end completes everything");
      take_note(n);
      report();
    }
    require_rows();
    audit_.finish();
    counts.audit_seconds += audit_seconds_ + lap();
    counts.write_seconds += seconds_.back();
    counts.complete += audit_.complete(), counts.incomplete += audit_.incomplete();
    rows_.finish();
    statistics_.certified = audit_.complete();
    for (const OperatorCall& call : calls_) statistics_.degenerate.push_back(call.degenerate());
    statistics_.read_seconds = seconds_[0], statistics_.search_seconds = seconds_[1];
    statistics_.stage_seconds.assign(seconds_.begin() + 2, seconds_.end() - 1);
    statistics_.mean_points = active_sum_ / static_cast<double>(std::max<std::uint64_t>(1, n));
    statistics_.lifespan_mean = lifespan_sum_ / static_cast<double>(std::max<std::uint64_t>(1, n));
    return std::move(statistics_);
  }

 private:
  const SharedRule& rule() const { return run_.pass.plan.neighborhood.rule; }
  Reach reach() const { return {run_.pass.plan.neighborhood.k, run_.pass.plan.neighborhood.radius2()}; }

  void append(const std::string& name, StreamOperator& op) {
    if (!operators_.empty()) op.set_prev(*operators_.back());
    operators_.push_back(&op);
    seconds_.push_back(0);
    statistics_.buffers.push_back({name, {}});
  }

  void append_stage(const Stage& stage) {
    OperatorCall& call = calls_.emplace_back(stage, [this] { report(); });
    if (stage.moves) {
      buffers_.push_back(std::make_unique<PrePostBuffer>(call));
    } else if (stage.waits) {
      buffers_.push_back(std::make_unique<PreBuffer>(call));
    } else {
      buffers_.push_back(std::make_unique<ThroughBuffer>(call));
    }
    append(name_of(stage.op), *buffers_.back());
  }

  double lap() {
    const Clock::time_point before = now_;
    now_ = Clock::now();
    return std::chrono::duration<double>(now_ - before).count();
  }

  /// Audits the neighbourhoods of this step. A step reads one point, which searches S (NearestOperator) before any
  /// point leaves S, so the arrived points are audited before the completed ones.
  void audit() {
    for (StreamPoint* point : nearest_.arrived()) {
      point->read_at = now_;
      audit_.arrived(*point);
    }
    for (StreamPoint* point : nearest_.completed()) audit_.completed(*point);
    audit_seconds_ += lap();
  }

  void write_point(StreamPoint& point) {
    audit_.written(point);
    if (write_.position() % kReportPoints == 0) report();
    const double lifespan = std::chrono::duration<double>(now_ - point.read_at).count();
    lifespan_sum_ += lifespan;
    statistics_.lifespan_max = std::max(statistics_.lifespan_max, lifespan);
    fields_.result(point, results_);
    rows_.add(point, fields_.record(point), results_.data());
  }

  void take_note(std::uint64_t n) {
    const std::uint64_t read = read_.position(), stride = (n + kRows - 1) / kRows;
    statistics_.peak_points = std::max<std::uint64_t>(statistics_.peak_points, active_.size());
    active_sum_ += static_cast<double>(active_.size());
    if (!nearest_.arrived().empty() && read % stride == 0) {
      statistics_.series.emplace_back(read, active_.size());
      for (std::size_t i = 0; i < operators_.size(); ++i)
        statistics_.buffers[i].second.emplace_back(read, operators_[i]->size());
    }
    // A measurement takes time proportional to the active set. With this interval, the cost for each point read is
    // constant.
    if (read - measured_at_ < std::max<std::uint64_t>(kMeasurePoints, active_.size() / 4)) return;
    measured_at_ = read;
    require_memory();
  }

  /// Stops a cancelled run, and reports progress at most every kReportSeconds. Also called while many points pass an
  /// operator in one step.
  void report() {
    stop_if_cancelled();
    const Clock::time_point now = Clock::now();
    if (!run_.progress || std::chrono::duration<double>(now - reported_).count() < kReportSeconds) return;
    reported_ = now;
    run_.progress(read_.position(), active_.size());
  }

  void require_rows() const {
    FirstRowError refused = read_.refused();
    for (const OperatorCall& call : calls_) refused.note(call.refused());
    refused.throw_if_any();
  }

  void require_memory() const {
    std::uint64_t bytes = audit_.bytes() + active_.size() * (sizeof(StreamPoint) + fields_.bytes() + kNodeBytes);
    for (const StreamPoint& point : active_) bytes += point.neighbors.bytes() + point.hidden.capacity() * sizeof(Rank);
    if (bytes <= run_.memory_bytes) return;
    fail(
        "The reference holds {} points, about {} MB, and its share of the memory budget is {} MB: raise --memory, or "
        "leave out --engine reference.",
        active_.size(), bytes >> 20, run_.memory_bytes >> 20);
  }

  const EnginePass& run_;
  Rows rows_;
  const Fields fields_;
  Shortening shortening_;
  ActiveSet active_;
  Audit audit_;
  ReadOperator read_;
  NearestOperator nearest_;
  std::deque<OperatorCall> calls_;
  std::vector<std::unique_ptr<StreamOperator>> buffers_;
  WriteOperator write_;
  std::vector<StreamOperator*> operators_;

  SweepStatistics statistics_;   ///< `buffers` has a series for each operator
  std::vector<double> seconds_;  ///< processing time of each operator
  double audit_seconds_ = 0;     ///< time of the audit, without Audit::written(), which counts as writing
  Clock::time_point now_, reported_;
  std::uint64_t measured_at_ = 0;  ///< number of points read at the last measurement of memory
  std::vector<std::byte> results_;
  double active_sum_ = 0, lifespan_sum_ = 0;
};

}  // namespace
}  // namespace reference

namespace {

class ReferenceEngine final : public SweepEngine {
 public:
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
    if (!statistics.reference) statistics.reference.emplace();
    return reference::Pipeline(pass).run(*statistics.reference);
  }
};

}  // namespace

void register_reference_engine() {
  static const ReferenceEngine engine;
  register_engine(Engine::reference, engine);
}

}  // namespace pointsweep
