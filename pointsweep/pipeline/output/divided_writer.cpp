// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/divided_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/named_field.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/order/parallel_rows.h"
#include "pointsweep/points/whole_numbers.h"
#include "pointsweep/storage/local/output_file.h"
#include "pointsweep/storage/local/unfinished_output.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

/// The first number of the file for points without a finite place; no tile has this number.
constexpr std::int64_t kUnplaced = std::numeric_limits<std::int64_t>::min();
constexpr std::uint64_t kMostWaitingBytes = 256 << 20;

fs::path with_name(const fs::path& pattern, const std::string& name) {
  std::string file = pattern.filename().string();
  return pattern.parent_path() / file.replace(file.find('*'), 1, name);
}

/// Replaces all characters except letters, digits, - and . by _.
std::string as_file_name(std::string name) {
  for (char& c : name)
    if (!(c >= 'a' && c <= 'z') && !(c >= 'A' && c <= 'Z') && !(c >= '0' && c <= '9') && c != '-' && c != '.') c = '_';
  return name;
}

/// The mark of points that belong to a neighbouring tile.
Attribute buffer_attribute() {
  return scalar("buffer", Type::u8, "1", "1: the point is in the buffer, and belongs to a neighbouring tile");
}

}  // namespace

std::size_t DividedWriter::KeyHash::operator()(const Key& key) const {
  return mix(mix(std::bit_cast<std::uint64_t>(key.first)) ^ std::bit_cast<std::uint64_t>(key.second));
}

DividedWriter::DividedWriter(OutputPlan plan, const OutputDivision& division, DivisionRoom room)
    : plan_(std::move(plan)), division_(division), room_(std::move(room)), record_bytes_(plan_.schema.stride) {
  if (division_.tile) {
    grid_.emplace(*division_.tile, division_.tile_origin);
    const PositionFields position = position_fields(plan_.schema, plan_.path.string());
    xy_ = {position.x, position.y};
  } else {
    choose_attribute(division_.split);
  }
  if (division_.tile_buffer > 0) {
    const Attribute buffer = buffer_attribute();
    if (plan_.schema.find(buffer.name))
      fail_usage(
          "--tile-buffer: the points have an attribute '{0}' already; leave out an earlier buffer with "
          "--pipeline 'where({0} == 0) | drop({0})'.",
          buffer.name);
    plan_.schema.append(buffer.name, buffer.type);
    plan_.made.push_back(buffer);
  }
  const Format* const format = format_of_output(plan_.path);
  if (grid_ && format != nullptr && format->stored_coordinate != nullptr) stored_ = format->stored_coordinate(plan_);
  OutputPlan trial = plan_;  // throws if the format cannot hold the records
  trial.path = with_name(plan_.path, "tile");
  trial.overwrite = true;
  create_writer(trial);
  records_.emplace(plan_.schema.stride, plan_.count, room_.bytes / 2, room_.scratch);
}

void DividedWriter::choose_attribute(const std::string& word) {
  attribute_ = named_field(plan_.schema, word, "--split");
  if (!has_whole_numbers(attribute_) || attribute_.count != 1)
    fail_usage(
        "--split: '{0}' has no whole numbers, so that nearly each point might get a file; make whole numbers of it, "
        "e.g. pointsweep run INPUT OUTPUT --pipeline 'set(part = floor({0}), as=int32)' --split part.",
        word);
  attribute_name_ = as_file_name(library_name_of(attribute_.name));
}

DividedWriter::Key DividedWriter::key_of(const std::byte* record) const {
  if (!grid_) return {whole_number_of(attribute_, record), 0};  // a u64 may wrap; name_of() reverses that
  std::array<std::int64_t, 2> tile{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    double coordinate = value_of(xy_[axis], record);
    if (stored_) coordinate = stored_(axis, coordinate);
    if (!std::isfinite(coordinate)) return {kUnplaced, 0};
    tile[axis] = grid_->tile_of(axis, coordinate);
  }
  return {tile[0], tile[1]};
}

void DividedWriter::find_keys(std::span<const std::byte> records) {
  keys_.resize(records.size() / record_bytes_);
  for_each_task(keys_.size(), [&](std::size_t first, std::size_t n) {
    for (std::size_t i = first; i < first + n; ++i) keys_[i] = key_of(records.data() + i * record_bytes_);
  });
}

void DividedWriter::write(std::span<const std::byte> records) {
  find_keys(records);
  came_ += keys_.size();
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (i % kTaskRows == 0) stop_if_cancelled();
    const std::byte* const record = records.data() + i * record_bytes_;
    put(keys_[i], record, true);
    if (division_.tile_buffer > 0 && keys_[i].first != kUnplaced) put_into_buffers(record, keys_[i]);
  }
}

void DividedWriter::put(Key key, const std::byte* record, bool is_own) {
  const auto [known, is_new] = file_of_.try_emplace(key, static_cast<std::uint32_t>(files_.size()));
  if (is_new) files_.push_back({key});
  File& file = files_[known->second];
  ++file.all;
  ++put_;
  if (is_own && file.own++ == 0 && ++with_points_ > kMostFiles && !plan_.overwrite)
    fail_usage("{}: more than {} files would be written; choose {}, or allow it (--force).",
               folder_of(plan_.path).string(), kMostFiles,
               grid_ ? "larger tiles" : "an attribute that has fewer values");
  std::byte* const to = records_->add(known->second);
  std::memcpy(to, record, record_bytes_);
  if (division_.tile_buffer > 0) to[record_bytes_] = std::byte{is_own ? std::uint8_t{0} : std::uint8_t{1}};
}

/// A buffer is at most as wide as a tile, so only the eight tiles around the point's tile can contain the point in
/// their buffer.
void DividedWriter::put_into_buffers(const std::byte* record, const Key& own) {
  const std::array<std::int64_t, 2> tile = {own.first, own.second};
  std::array<std::array<bool, 3>, 2> reaches{};  // for each axis: the previous tile, the own tile, the next tile
  for (std::size_t axis = 0; axis < 2; ++axis) {
    double coordinate = value_of(xy_[axis], record);
    if (stored_) coordinate = stored_(axis, coordinate);
    reaches[axis] = {coordinate < grid_->edge(axis, tile[axis]) + division_.tile_buffer, true,
                     coordinate >= grid_->edge(axis, tile[axis] + 1) - division_.tile_buffer};
  }
  for (std::size_t x = 0; x < 3; ++x)
    for (std::size_t y = 0; y < 3; ++y)
      if (reaches[0][x] && reaches[1][y] && !(x == 1 && y == 1))
        put({tile[0] + static_cast<std::int64_t>(x) - 1, tile[1] + static_cast<std::int64_t>(y) - 1}, record, false);
}

std::string DividedWriter::name_of(const Key& key) const {
  if (key.first == kUnplaced && grid_) return "unplaced";
  if (grid_) return grid_->edge_text(0, key.first) + "_" + grid_->edge_text(1, key.second);
  if (attribute_.type == Type::u64)
    return fmt::format("{}_{}", attribute_name_, std::bit_cast<std::uint64_t>(key.first));
  return fmt::format("{}_{}", attribute_name_, key.first);
}

fs::path DividedWriter::path_of(std::uint32_t file) const { return with_name(plan_.path, name_of(files_[file].key)); }

OutputPlan DividedWriter::plan_of(std::uint32_t file) const {
  OutputPlan plan = plan_;
  plan.path = path_of(file);
  plan.count = files_[file].all;
  return plan;
}

void DividedWriter::require_possible() const {
  for (std::uint32_t file = 0; file < files_.size(); ++file)
    if (files_[file].own > 0) OutputFile::require_possible(path_of(file), plan_.overwrite);
}

void DividedWriter::complete_large(Writer& writer, std::uint32_t file) {
  writer.finish();
  ++complete_;
  bytes_written_ += writer.bytes_written();
  file_warnings_.add(writer.warnings(), path_of(file));
}

void DividedWriter::write_together(std::vector<Waiting>& waiting) {
  std::vector<std::uint64_t> bytes(waiting.size());
  std::vector<std::vector<std::string>> warnings(waiting.size());
  parallel_for(waiting.size(), [&](std::size_t i, unsigned) {
    stop_if_cancelled();
    const std::unique_ptr<Writer> writer = create_writer(plan_of(waiting[i].file));
    writer->write(std::exchange(waiting[i].records, {}));
    writer->finish();
    ++complete_;
    bytes[i] = writer->bytes_written();
    warnings[i] = writer->warnings();
  });
  for (std::size_t i = 0; i < waiting.size(); ++i) {
    bytes_written_ += bytes[i];
    file_warnings_.add(warnings[i], path_of(waiting[i].file));
  }
  waiting.clear();
}

/// Reports progress as a number of points. `records`: records done, including copies in buffers.
void DividedWriter::report(std::uint64_t records) const {
  if (!room_.progress) return;
  const double share = static_cast<double>(records) / static_cast<double>(put_);
  room_.progress(static_cast<std::uint64_t>(share * static_cast<double>(came_)));
}

void DividedWriter::write_files() {
  const std::uint64_t most_waiting = std::min(kMostWaitingBytes, room_.bytes / 4);
  const std::size_t record_bytes = plan_.schema.stride;
  std::vector<Waiting> waiting;
  std::uint64_t waiting_bytes = 0;
  std::unique_ptr<Writer> large;  // writer of a file whose records are written as they come
  std::uint64_t left = 0;         // records of the current file that have not come yet
  std::uint64_t done = 0;
  records_->for_each([&](std::uint32_t number, std::span<const std::byte> records) {
    report(done += records.size() / record_bytes);
    const File& file = files_[number];
    if (file.own == 0) return;  // a tile with nothing but a buffer gets no file
    const std::uint64_t bytes = file.all * record_bytes;
    if (left == 0) {
      left = file.all;
      if (bytes > most_waiting) {
        large = create_writer(plan_of(number));
      } else {
        if (waiting_bytes + bytes > most_waiting) write_together(waiting), waiting_bytes = 0;
        waiting.push_back({number, {}});
        waiting.back().records.reserve(bytes);
        waiting_bytes += bytes;
      }
    }
    left -= records.size() / record_bytes;
    if (!large)
      return void(waiting.back().records.insert(waiting.back().records.end(), records.begin(), records.end()));
    large->write(records);
    if (left == 0) complete_large(*std::exchange(large, nullptr), number);
  });
  write_together(waiting);
}

void DividedWriter::finish() {
  if (came_ != plan_.count)
    fail("{}: {} points were announced, but {} came; nothing was written.", plan_.path.string(), plan_.count, came_);
  require_possible();
  const ManyOutputs outputs(files_.size(),
                            [this](std::size_t file) { return path_of(static_cast<std::uint32_t>(file)); });
  try {
    write_files();
  } catch (const UsageError&) {
    throw;
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    if (complete_ == 0) throw;
    fail("{} {} of {} outputs are complete and stay.", error.what(), complete_.load(), with_points_);
  }
  for (const std::string& sentence : file_warnings_.sentences()) add_warning(sentence);
  const auto unplaced = file_of_.find({kUnplaced, 0});
  if (grid_ && unplaced != file_of_.end())
    add_warning(fmt::format("{}: {} points have no finite x and y, and are in no tile.",
                            path_of(unplaced->second).string(), files_[unplaced->second].all));
}

}  // namespace pointsweep
