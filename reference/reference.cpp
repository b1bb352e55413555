// SPDX-License-Identifier: MIT
#include "reference/reference.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <deque>

#include "pointsweep/cancellation.h"
#include "pointsweep/error.h"
#include "reference/audit.h"
#include "reference/nearest_operator.h"
#include "reference/pre_post_buffer.h"
#include "reference/read_operator.h"
#include "reference/through_buffer.h"
#include "reference/write_operator.h"

namespace pointsweep::reference {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::uint64_t kRows = 1000;             ///< of a series
constexpr std::uint64_t kReportPoints = 1 << 14;  ///< read between two reports
constexpr std::uint64_t kNodeBytes = 128;         ///< of a point's place in a kD-heap and in queues, about

/// The main routine of Figure 16.
class Pipeline {
 public:
  Pipeline(const Stream& stream, const Task& task, const std::function<void(const Written&)>& write,
           const Options& options)
      : task_(task),
        write_results_(write),
        options_(options),
        fields_(stream.record_schema(), task.operators, task.kept),
        audit_(stream.axis()),
        read_(stream, fields_, task.reach, active_),
        nearest_(stream.axis()),
        write_(active_, [this](StreamPoint& point) { write_point(point); }) {
    append("read", read_);
    append("knn", nearest_);
    for (const Stage& stage : fields_.stages()) append_stage(stage);
    append("write", write_);
  }

  Statistics run() {
    const std::uint64_t n = read_.total();
    now_ = Clock::now();
    while (write_.position() < n) {
      stop_if_cancelled();
      for (std::size_t i = 0; i < operators_.size(); ++i) {
        operators_[i]->pull_push();
        statistics_.operators[i].seconds += lap();
        if (operators_[i] == &nearest_) audit();
      }
      assert((read_.position() < n || active_.empty()) && "the end of the stream completes everything");
      take_note(n);
    }
    statistics_.mean_points = active_sum_ / static_cast<double>(std::max<std::uint64_t>(1, n));
    statistics_.lifespan_mean = lifespan_sum_ / static_cast<double>(std::max<std::uint64_t>(1, n));
    for (const OperatorCall& call : calls_) statistics_.degenerate += call.degenerate();
    statistics_.complete = audit_.complete();
    statistics_.overlooked = audit_.overlooked();
    statistics_.unknown = audit_.unknown();
    return std::move(statistics_);
  }

 private:
  void append(const std::string& name, StreamOperator& op) {
    if (!operators_.empty()) op.set_prev(*operators_.back());
    operators_.push_back(&op);
    statistics_.operators.push_back({name, 0, {}});
  }

  void append_stage(const Stage& stage) {
    OperatorCall& call = calls_.emplace_back(stage);
    if (stage.moves) {
      buffers_.push_back(std::make_unique<PrePostBuffer>(call));
    } else if (stage.waits) {
      buffers_.push_back(std::make_unique<PreBuffer>(call));
    } else {
      buffers_.push_back(std::make_unique<ThroughBuffer>(call));
    }
    append(stage.op->name(), *buffers_.back());
  }

  double lap() {
    const Clock::time_point before = now_;
    now_ = Clock::now();
    return std::chrono::duration<double>(now_ - before).count();
  }

  /// A step reads one point, so none that arrived could have seen what left S in the same step.
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
    const double lifespan = std::chrono::duration<double>(now_ - point.read_at).count();
    lifespan_sum_ += lifespan;
    statistics_.lifespan_max = std::max(statistics_.lifespan_max, lifespan);
    fields_.result(point, results_);
    write_results_({point.index, point.row, fields_.record(point), results_.data(), point.complete});
  }

  void take_note(std::uint64_t n) {
    const std::uint64_t read = read_.position(), stride = (n + kRows - 1) / kRows;
    statistics_.peak_points = std::max<std::uint64_t>(statistics_.peak_points, active_.size());
    active_sum_ += static_cast<double>(active_.size());
    if (read % stride == 0) {
      statistics_.series.emplace_back(read, active_.size());
      for (std::size_t i = 0; i < operators_.size(); ++i)
        statistics_.operators[i].series.emplace_back(read, operators_[i]->size());
    }
    if (read % kReportPoints != 0) return;
    if (options_.progress) options_.progress(read, active_.size());
    require_memory();
  }

  void require_memory() const {
    const std::uint64_t point_bytes =
        sizeof(StreamPoint) + fields_.bytes() + std::min<std::uint64_t>(task_.reach.k, 1024) * sizeof(Neighbor);
    const std::uint64_t bytes = active_.size() * (point_bytes + kNodeBytes);
    if (bytes <= options_.memory_bytes) return;
    fail(
        "The reference holds {} points, about {} MB, and its share of the memory budget is {} MB: raise --memory, or "
        "leave out --engine reference.",
        active_.size(), bytes >> 20, options_.memory_bytes >> 20);
  }

  const Task& task_;
  const std::function<void(const Written&)>& write_results_;
  const Options& options_;
  const Fields fields_;
  ActiveSet active_;
  Audit audit_;
  ReadOperator read_;
  NearestOperator nearest_;
  std::deque<OperatorCall> calls_;
  std::vector<std::unique_ptr<StreamOperator>> buffers_;
  WriteOperator write_;
  std::vector<StreamOperator*> operators_;

  Statistics statistics_;
  Clock::time_point now_;
  std::vector<std::byte> results_;
  double active_sum_ = 0, lifespan_sum_ = 0;
};

}  // namespace

Statistics run(const Stream& stream, const Task& task, const std::function<void(const Written&)>& write,
               const Options& options) {
  return Pipeline(stream, task, write, options).run();
}

}  // namespace pointsweep::reference
