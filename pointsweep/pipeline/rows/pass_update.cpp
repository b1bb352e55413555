// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/pass_update.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

std::uint64_t blocks_of(std::uint64_t rows) { return (rows + RowSelection::kBlockRows - 1) / RowSelection::kBlockRows; }

RowSelection selection_in(const std::shared_ptr<RowFile>& file, std::uint64_t rows) {
  return {rows, [file](std::uint64_t block, std::span<std::byte> bits) { file->read(block, bits); }};
}

/// Returns whether the positions or the payload of the pass include a field of the input's record.
bool looks_at_input(const PlannedPass& pass, std::size_t input_stride) {
  std::vector<std::size_t> fields = pass.payload();
  for (const std::size_t f : position_columns(pass.input)) fields.push_back(f);
  return std::ranges::any_of(fields, [&](std::size_t f) { return pass.input.fields[f].offset < input_stride; });
}

/// Copies `n` records of `bytes` bytes to places `stride` bytes apart.
void spread(const std::byte* from, std::size_t bytes, std::size_t n, std::size_t stride, std::byte* to) {
  for (std::size_t i = 0; i < n; ++i) std::memcpy(to + i * stride, from + i * bytes, bytes);
}

/// Returns the number of rows of the cloud before any select.
std::uint64_t all_rows(const InputCloud& cloud) {
  return cloud.selection() ? cloud.selection()->rows() : cloud.count();
}

}  // namespace

PassValues::PassValues(const PlannedPass& pass, const Schema& input)
    : carried_bytes_(pass.carried_bytes()), input_bytes_(input.stride) {
  for (const PlannedValue& value : pass.values) {
    Sum& sum = sums_.emplace_back();
    sum.value = value;
    for (const Attribute& a : value.reduction->reads())
      for (std::size_t c = 0; c < a.fields.size(); ++c)
        sum.reads.push_back(value.reduction->of_input() ? of_input(a, c, input) : component_of(a, c, pass, input));
    for (unsigned t = 0; t < thread_count(); ++t) sum.parts.push_back(value.reduction->start());
  }
}

PassValues::Component PassValues::component_of(const Attribute& attribute, std::size_t c, const PlannedPass& pass,
                                               const Schema& input) {
  std::size_t offset = 0;
  for (const Attribute& a : pass.carried) {
    if (a.name == attribute.name)
      return {{.name = "", .type = a.type, .offset = static_cast<std::uint32_t>(offset + c * size_of(a.type))}, true};
    offset += a.bytes();
  }
  return of_input(attribute, c, input);
}

PassValues::Component PassValues::of_input(const Attribute& attribute, std::size_t c, const Schema& input) {
  needs_input_ = true;
  return {input.fields[field_meant(input, attribute.fields[c]).value()], false};
}

void PassValues::add(unsigned worker, const std::byte* carried, const std::byte* inputs, std::size_t n) {
  for (Sum& sum : sums_) {
    std::vector<double> values;
    values.reserve(n * sum.reads.size());
    for (std::size_t i = 0; i < n; ++i)
      for (const Component& c : sum.reads)
        values.push_back(value_of(c.field, c.carried ? carried + i * carried_bytes_ : inputs + i * input_bytes_));
    sum.parts[worker]->add(values.data(), n);
  }
}

void PassValues::finish(CloudValues& into) const {
  for (const Sum& sum : sums_) into[sum.value.number] = sum.all()->finish();
}

std::vector<std::vector<std::byte>> PassValues::save() const {
  std::vector<std::vector<std::byte>> saved;
  for (const Sum& sum : sums_) saved.push_back(sum.all()->save());
  return saved;
}

std::unique_ptr<Accumulator> PassValues::Sum::all() const {
  std::unique_ptr<Accumulator> all = value.reduction->start();
  for (const auto& part : parts) all->merge(*part);
  return all;
}

void finish_values(const PlannedPass& pass, const std::vector<std::vector<std::vector<std::byte>>>& saved,
                   CloudValues& into) {
  for (std::size_t v = 0; v < pass.values.size(); ++v) {
    const std::unique_ptr<Accumulator> all = pass.values[v].reduction->start();
    for (const auto& of_part : saved) {
      if (of_part.size() != pass.values.size()) fail("a part has saved other values of the cloud than the run needs.");
      all->load(of_part[v]);
    }
    into[pass.values[v].number] = all->finish();
  }
}

PlannedPass ready_pass(PlannedPass pass, const CloudValues& values, const Schema& records) {
  for (std::size_t s = 0; s < pass.values_of_stages.size(); ++s) {
    if (pass.values_of_stages[s].empty()) continue;
    std::vector<std::vector<double>> given;
    for (const std::size_t number : pass.values_of_stages[s]) given.push_back(values.at(number));
    Stage& stage = pass.plan.stages[s];
    stage.op = std::get<std::shared_ptr<const LocalOperator>>(stage.op)->with_values(given);
  }
  pass.bind(records);
  return pass;
}

RowMask::RowMask(std::uint64_t rows, const RowSelection* before, const SpillPlace& spill)
    : rows_(rows),
      file_(std::make_shared<RowFile>(blocks_of(rows), RowSelection::kBlockBytes, spill)),
      block_(RowSelection::kBlockBytes) {
  if (before != nullptr) before_.emplace(*before);
}

void RowMask::append(std::span<const std::uint8_t> kept) {
  for (const std::uint8_t k : kept) {
    while (before_ && next_ < rows_ && !before_->has(next_)) append_any(false);
    append_any(k != 0);
  }
}

void RowMask::append_any(bool kept) {
  const std::uint64_t i = next_++ % RowSelection::kBlockRows;
  if (kept) block_[i / 8] |= std::byte{1} << i % 8;
  if (i + 1 < RowSelection::kBlockRows) return;
  file_->append(block_);
  std::ranges::fill(block_, std::byte{0});
}

RowSelection RowMask::finish() {
  while (next_ < rows_) append_any(false);
  if (next_ % RowSelection::kBlockRows != 0) file_->append(block_);
  return selection_in(file_, rows_);
}

RowSelection RowMask::kept(std::uint64_t rows, const SpillPlace& kept) {
  return selection_in(std::make_shared<RowFile>(RowFile::kept(blocks_of(rows), RowSelection::kBlockBytes, kept)), rows);
}

std::uint64_t RowMask::bytes(std::uint64_t rows) { return blocks_of(rows) * (RowSelection::kBlockBytes + 8); }

RowUpdate::RowUpdate(const std::vector<Attribute>& carried, const std::vector<Attribute>& made,
                     const std::vector<Attribute>& after)
    : carried_bytes_(bytes_of(carried)), made_bytes_(bytes_of(made)), after_bytes_(bytes_of(after)) {
  std::size_t to = 0;
  for (const Attribute& a : after) {
    if (const auto at = offset_in(made, a.name))
      from_made_.add(*at, to, a.bytes());
    else
      from_carried_.add(offset_in(carried, a.name).value(), to, a.bytes());
    to += a.bytes();
  }
}

void RowUpdate::run(const std::byte* carried, const std::byte* made, std::size_t n, std::byte* after) const {
  from_carried_.copy(carried, carried_bytes_, after, after_bytes_, n);
  from_made_.copy(made, made_bytes_, after, after_bytes_, n);
}

void update_rows(const MadeRows& results, const RowFile* carried, const RowUpdate& update,
                 const std::function<void(const UpdatedRows&)>& use) {
  const std::size_t made_bytes = update.made_bytes();
  const std::size_t before = carried == nullptr ? 0 : carried->record_bytes();
  const std::size_t chunk = rows_at_once(std::max(before, update.record_bytes()));
  std::vector<std::byte> old, updated;
  results([&](std::uint64_t first, std::size_t rows, const std::byte* made) {
    for (std::size_t at = 0; at < rows; at += chunk) {
      const std::size_t n = std::min(chunk, rows - at);
      old.resize(n * before);
      updated.resize(n * update.record_bytes());
      for_each_task(n, [&](std::size_t row, std::size_t m) {
        const auto own = std::span(old).subspan(row * before, m * before);
        if (carried != nullptr) carried->read(first + at + row, own);
        update.run(own.data(), made + (at + row) * made_bytes, m, updated.data() + row * update.record_bytes());
      });
      use({first + at, n, made + at * made_bytes, updated.data()});
    }
  });
}

PointSource updated_source(const PointSource& input, const RowFile& carried, const PlannedPass& pass) {
  const std::size_t stride = pass.input.stride, own = input.schema.stride, rest = stride - own;
  // Joins fields of the input with carried records. `read` reads the input, and is empty if the pass needs no field of
  // the input.
  const auto joining = [=, &carried, count = input.count](ReadRows read) -> ReadRows {
    return [=, &carried, read = std::move(read), scratch = std::vector<std::byte>()](
               std::uint64_t row, std::span<std::byte> records) mutable -> std::size_t {
      std::size_t n = records.size() / stride;
      n = static_cast<std::size_t>(std::min<std::uint64_t>(n, row < count ? count - row : 0));
      if (scratch.size() < n * std::max(own, rest)) scratch.resize(n * std::max(own, rest));
      if (read) {
        n = read(row, std::span(scratch).first(n * own));
        spread(scratch.data(), own, n, stride, records.data());
      }
      carried.read(row, std::span(scratch).first(n * rest));
      spread(scratch.data(), rest, n, stride, records.data() + own);
      return n;
    };
  };
  if (!looks_at_input(pass, own)) {
    const auto of_carried = [joining](const std::vector<std::size_t>&) { return joining({}); };
    return {pass.input, input.count, joining({}), of_carried};
  }
  const auto for_thread = [=, make = input.for_thread, fields = pass.input.fields](std::vector<std::size_t> wanted) {
    std::erase_if(wanted, [&](std::size_t f) { return fields[f].offset >= own; });
    ReadRows read = make(wanted);
    return read ? joining(std::move(read)) : ReadRows();
  };
  return {pass.input, input.count, joining(input.read), for_thread, input.chunk_end};
}

PassUpdate::PassUpdate(const PlannedPass& pass, const InputCloud& cloud, PointSource input, const SpillPlace& rows,
                       const SpillPlace& mask)
    : cloud_(cloud),
      carried_bytes_(pass.carried_bytes()),
      made_bytes_(pass.plan.result_bytes),
      rows_(std::make_unique<RowFile>(cloud.count(), carried_bytes_, rows)),
      values_(pass, cloud.schema()),
      input_rows_(std::move(input)),
      rooms_(thread_count()) {
  if (!pass.selects) return;
  mask_.emplace(all_rows(cloud), cloud.selection().get(), mask);
  selection_at_ = offset_in(pass.made, selection_attribute().name).value();
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

/// Cuts the rows into tasks, and finds the place of each in rows_, after the kept rows of earlier tasks.
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

/// Decides which rows are kept, and counts them for each task.
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

/// Stores the kept rows of a task, and reduces them into the values of the whole cloud (PassValues).
void PassUpdate::keep(const UpdatedRows& rows, const Task& task, unsigned worker) {
  Room& room = rooms_[worker];
  const std::byte* const carried = compact(rows.after, carried_bytes_, task, room.carried);
  rows_->write(task.place, {carried, task.kept * carried_bytes_});
  const bool reads = values_.needs_input();
  values_.add(worker, carried, reads ? compact(inputs_.data(), cloud_.schema().stride, task, room.inputs) : nullptr,
              task.kept);
}

/// Returns the kept records of a task, one after another; in `room` if the task drops some.
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
  spilled_bytes_ += rows_->spilled_bytes();
  return std::move(rows_);
}

std::optional<RowSelection> PassUpdate::take_selection() {
  if (!mask_) return std::nullopt;
  RowSelection kept = mask_->finish();
  spilled_bytes_ += mask_->spilled_bytes();
  return kept;
}

}  // namespace pointsweep
