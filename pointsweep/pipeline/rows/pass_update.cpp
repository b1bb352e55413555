// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/pass_update.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// The rows of the cloud before any select.
std::uint64_t all_rows(const InputCloud& cloud) {
  return cloud.selection() ? cloud.selection()->rows() : cloud.count();
}

}  // namespace

PassUpdate::PassUpdate(const PlannedPass& pass, InputCloud& cloud, PointSource input, std::size_t carried_bytes,
                       const SpillPlace& rows, const SpillPlace& mask)
    : cloud_(cloud),
      carried_bytes_(carried_bytes),
      made_bytes_(pass.plan.result_bytes),
      rows_(std::make_unique<RowFile>(cloud.count(), carried_bytes, rows)),
      values_(pass, cloud.schema()),
      input_rows_(std::move(input)),
      rooms_(thread_count()) {
  if (!pass.selects) return;
  mask_.emplace(all_rows(cloud), cloud.selection(), mask);
  for (const Attribute& a : pass.made) {
    if (a.name == selection_attribute().name) return;
    selection_at_ += a.bytes();
  }
}

void PassUpdate::add(const UpdatedRows& rows) {
  if (values_.needs_input()) {
    inputs_.resize(rows.count * cloud_.schema().stride);
    input_rows_.read(rows.first, inputs_);
  }
  const std::vector<Task> tasks = tasks_of(rows);
  std::optional<BackgroundTask> masking;
  if (mask_) masking.emplace([this] { mask_->append(kept_); });
  parallel_for(tasks.size(), [&](std::size_t t, unsigned worker) { keep(rows, tasks[t], worker); });
  if (masking) masking->wait();
}

/// Cuts the rows into tasks and finds the place of each in rows_: as many are before it as the tasks before it keep.
std::vector<PassUpdate::Task> PassUpdate::tasks_of(const UpdatedRows& rows) {
  std::vector<Task> tasks;
  for (std::size_t first = 0; first < rows.count; first += kTaskRows) {
    const std::size_t count = std::min(kTaskRows, rows.count - first);
    tasks.push_back({.first = first, .count = count, .kept = count});
  }
  if (mask_) decide(rows, tasks);
  std::uint64_t all = 0;
  for (Task& task : tasks) task.place = std::exchange(all, all + task.kept);
  const std::uint64_t first = rows_->extend(all);
  for (Task& task : tasks) task.place += first;
  return tasks;
}

/// Finds the rows that are kept, and how many they are of each task.
void PassUpdate::decide(const UpdatedRows& rows, std::vector<Task>& tasks) {
  kept_.resize(rows.count);
  parallel_for(tasks.size(), [&](std::size_t t, unsigned) {
    Task& task = tasks[t];
    task.kept = 0;
    for (std::size_t i = task.first; i < task.first + task.count; ++i) {
      kept_[i] = rows.made[i * made_bytes_ + selection_at_] != std::byte{0};
      task.kept += kept_[i];
    }
  });
}

/// Stores the kept rows of a task and adds them to the values.
void PassUpdate::keep(const UpdatedRows& rows, const Task& task, unsigned worker) {
  Room& room = rooms_[worker];
  const std::byte* const carried = compact(rows.after, carried_bytes_, task, room.carried);
  rows_->write(task.place, {carried, task.kept * carried_bytes_});
  const bool reads = values_.needs_input();
  values_.add(worker, carried, reads ? compact(inputs_.data(), cloud_.schema().stride, task, room.inputs) : nullptr,
              task.kept);
}

/// Returns the records of the rows that a task keeps one after another: in `room` if it leaves out some.
const std::byte* PassUpdate::compact(const std::byte* records, std::size_t bytes, const Task& task,
                                     std::vector<std::byte>& room) const {
  if (task.kept == task.count) return records + task.first * bytes;
  room.resize(task.kept * bytes);
  std::byte* to = room.data();
  for (std::size_t i = task.first; i < task.first + task.count && bytes != 0; ++i) {
    if (kept_[i] == 0) continue;
    std::memcpy(to, records + i * bytes, bytes);
    to += bytes;
  }
  return room.data();
}

std::unique_ptr<RowFile> PassUpdate::finish(CloudValues& values) {
  values_.finish(values);
  spilled_bytes_ = rows_->spilled_bytes();
  if (mask_) {
    RowSelection left = mask_->finish();
    spilled_bytes_ += mask_->spilled_bytes();
    cloud_.select(std::move(left));
  }
  return std::move(rows_);
}

}  // namespace pointsweep
