// SPDX-License-Identifier: MIT
#include "reference/reference.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <deque>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "reference/audit.h"
#include "reference/buffers.h"
#include "reference/nearest_operator.h"
#include "reference/read_write_operators.h"

namespace pointsweep::reference {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::uint64_t kRows = 1000;              ///< most entries of a series
constexpr std::uint64_t kMeasurePoints = 1 << 12;  ///< least number of points read between two measurements of memory
constexpr std::uint64_t kNodeBytes = 128;          ///< approximate bytes of a point in a kD-heap and in queues
constexpr double kReportSeconds = 0.1;
constexpr std::uint64_t kReportPoints = 1024;  ///< points written between two readings of the clock

/// The main routine of Figure 16.
class Pipeline {
 public:
  Pipeline(const Stream& stream, const Task& task, const std::function<void(const Written&)>& write,
           const Options& options)
      : write_results_(write),
        options_(options),
        fields_(stream.record_schema(), task.rule, task.operators, task.kept),
        shortening_(task.rule, fields_),
        audit_(stream, task.reach, shortening_),
        read_(stream, fields_, task.reach, active_),
        nearest_(stream.axis(), shortening_),
        write_(active_, [this](StreamPoint& point) { write_point(point); }) {
    append("read", read_);
    append("knn", nearest_);
    for (const Stage& stage : fields_.stages()) append_stage(stage);
    append("write", write_);
  }

  Statistics run() {
    const std::uint64_t n = read_.total();
    now_ = reported_ = Clock::now();
    while (write_.position() < n) {
      for (std::size_t i = 0; i < operators_.size(); ++i) {
        operators_[i]->pull_push();
        statistics_.operators[i].seconds += lap();
        if (operators_[i] == &nearest_) audit();
      }
      assert((read_.position() < n || nearest_.searched() > 0 || active_.empty()) && "the end completes everything");
      take_note(n);
      report();
    }
    require_rows();
    audit_.finish();
    statistics_.audit_seconds += lap();
    statistics_.mean_points = active_sum_ / static_cast<double>(std::max<std::uint64_t>(1, n));
    statistics_.lifespan_mean = lifespan_sum_ / static_cast<double>(std::max<std::uint64_t>(1, n));
    for (const OperatorCall& call : calls_) statistics_.degenerate.push_back(call.degenerate());
    statistics_.complete = audit_.complete();
    statistics_.incomplete = audit_.incomplete();
    return std::move(statistics_);
  }

 private:
  void append(const std::string& name, StreamOperator& op) {
    if (!operators_.empty()) op.set_prev(*operators_.back());
    operators_.push_back(&op);
    statistics_.operators.push_back({name, 0, {}});
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

  /// A step reads one point, which searches S before any point leaves S in this step. So no point that leaves is hidden
  /// from it.
  void audit() {
    for (StreamPoint* point : nearest_.arrived()) {
      point->read_at = now_;
      audit_.arrived(*point);
    }
    for (StreamPoint* point : nearest_.completed()) audit_.completed(*point);
    statistics_.audit_seconds += lap();
  }

  void write_point(StreamPoint& point) {
    audit_.written(point);
    if (write_.position() % kReportPoints == 0) report();
    const double lifespan = std::chrono::duration<double>(now_ - point.read_at).count();
    lifespan_sum_ += lifespan;
    statistics_.lifespan_max = std::max(statistics_.lifespan_max, lifespan);
    fields_.result(point, results_);
    write_results_({point.index, point.row, fields_.record(point), results_.data()});
  }

  void take_note(std::uint64_t n) {
    const std::uint64_t read = read_.position(), stride = (n + kRows - 1) / kRows;
    statistics_.peak_points = std::max<std::uint64_t>(statistics_.peak_points, active_.size());
    active_sum_ += static_cast<double>(active_.size());
    if (!nearest_.arrived().empty() && read % stride == 0) {
      statistics_.series.emplace_back(read, active_.size());
      for (std::size_t i = 0; i < operators_.size(); ++i)
        statistics_.operators[i].series.emplace_back(read, operators_[i]->size());
    }
    // With this interval, all measurements together cost no more than a few steps for each point.
    if (read - measured_at_ < std::max<std::uint64_t>(kMeasurePoints, active_.size() / 4)) return;
    measured_at_ = read;
    require_memory();
  }

  /// Reports progress. Also called while many points pass an operator in one step.
  void report() {
    stop_if_cancelled();
    const Clock::time_point now = Clock::now();
    if (!options_.progress || std::chrono::duration<double>(now - reported_).count() < kReportSeconds) return;
    reported_ = now;
    options_.progress(read_.position(), active_.size());
  }

  void require_rows() const {
    FirstRowError refused = read_.refused();
    for (const OperatorCall& call : calls_) refused.note(call.refused());
    refused.throw_if_any();
  }

  void require_memory() const {
    std::uint64_t bytes = audit_.bytes() + active_.size() * (sizeof(StreamPoint) + fields_.bytes() + kNodeBytes);
    for (const StreamPoint& point : active_) bytes += point.neighbors.bytes() + point.hidden.capacity() * sizeof(Rank);
    if (bytes <= options_.memory_bytes) return;
    fail(
        "The reference holds {} points, about {} MB, and its share of the memory budget is {} MB: raise --memory, or "
        "leave out --engine reference.",
        active_.size(), bytes >> 20, options_.memory_bytes >> 20);
  }

  const std::function<void(const Written&)>& write_results_;
  const Options& options_;
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

  Statistics statistics_;
  Clock::time_point now_, reported_;
  std::uint64_t measured_at_ = 0;  ///< number of points read at the last measurement of memory
  std::vector<std::byte> results_;
  double active_sum_ = 0, lifespan_sum_ = 0;
};

}  // namespace

Statistics run(const Stream& stream, const Task& task, const std::function<void(const Written&)>& write,
               const Options& options) {
  return Pipeline(stream, task, write, options).run();
}

}  // namespace pointsweep::reference
